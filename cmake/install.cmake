# `cmake --install`: the library, its headers, the program, and the package that find_package(meniscus) finds.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/meniscus)

install(TARGETS meniscus EXPORT meniscusTargets)
install(EXPORT meniscusTargets NAMESPACE meniscus:: DESTINATION ${package_dir})
install(DIRECTORY include/meniscus DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
if(MENISCUS_APPS)
  install(TARGETS meniscus_app)
endif()

get_target_property(MENISCUS_LIBRARY_TYPE meniscus TYPE)
foreach(list IN ITEMS PACKAGES MODULES HDF5_MODULES)
  list(JOIN MENISCUS_LINK_${list} " " MENISCUS_CONFIG_${list})
endforeach()
configure_package_config_file(cmake/meniscusConfig.cmake.in ${PROJECT_BINARY_DIR}/package/meniscusConfig.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/meniscusConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/meniscusConfig.cmake
  ${PROJECT_BINARY_DIR}/package/meniscusConfigVersion.cmake DESTINATION ${package_dir})
