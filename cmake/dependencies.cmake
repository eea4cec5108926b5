# Everything comes from Debian's packages (packages.txt); nothing is downloaded, nothing vendored.

# What the library links: a program that uses the static library needs these as well, so the installed package
# looks for the same list (meniscusConfig.cmake.in).
set(MENISCUS_LINK_PACKAGES glm TBB hwy PNG OpenEXR ZLIB pugixml fmt Threads embree assimp)
set(MENISCUS_LINK_MODULES libdeflate libavcodec libavformat libavutil libswscale)  # pkg-config
set(MENISCUS_LINK_HDF5_MODULES hdf5-serial hdf5)                        # pkg-config, the first that is there
set(MENISCUS_LINK_TARGETS TBB::tbb hwy::hwy PNG::PNG OpenEXR::OpenEXR ZLIB::ZLIB pugixml::pugixml fmt::fmt Threads::Threads embree assimp::assimp
  PkgConfig::MENISCUS_MODULES PkgConfig::MENISCUS_HDF5)
foreach(package IN LISTS MENISCUS_LINK_PACKAGES)
  find_package(${package} REQUIRED)
endforeach()
find_package(PkgConfig REQUIRED)
pkg_check_modules(MENISCUS_MODULES REQUIRED IMPORTED_TARGET ${MENISCUS_LINK_MODULES})
pkg_search_module(MENISCUS_HDF5 REQUIRED IMPORTED_TARGET ${MENISCUS_LINK_HDF5_MODULES})

# Headers only: they leave nothing to link.
find_package(nlohmann_json REQUIRED)
find_package(FastFloat REQUIRED)
find_package(CLI11 REQUIRED)
find_path(MENISCUS_STB_INCLUDE_DIR stb_image.h PATH_SUFFIXES stb REQUIRED)

add_library(meniscus_dependencies INTERFACE)
target_link_libraries(meniscus_dependencies INTERFACE
  glm::glm ${MENISCUS_LINK_TARGETS} nlohmann_json::nlohmann_json FastFloat::fast_float)
target_include_directories(meniscus_dependencies SYSTEM INTERFACE ${MENISCUS_STB_INCLUDE_DIR})
