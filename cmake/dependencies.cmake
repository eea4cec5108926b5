# Everything comes from Debian's packages (packages.txt); nothing is downloaded, nothing vendored.
find_package(glm REQUIRED)
find_package(TBB REQUIRED)
find_package(hwy REQUIRED CONFIG)
find_package(PNG REQUIRED)
find_package(OpenEXR REQUIRED CONFIG)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(ZLIB REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(FastFloat REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(FFMPEG REQUIRED IMPORTED_TARGET libavcodec libavformat libavutil libswscale)

add_library(meniscus_dependencies INTERFACE)
target_link_libraries(meniscus_dependencies INTERFACE
  glm::glm TBB::tbb hwy::hwy PNG::PNG OpenEXR::OpenEXR ZLIB::ZLIB nlohmann_json::nlohmann_json
  FastFloat::fast_float fmt::fmt Threads::Threads PkgConfig::FFMPEG ${HDF5_C_LIBRARIES})
target_include_directories(meniscus_dependencies SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS} /usr/include/stb)
