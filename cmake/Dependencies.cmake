# Every dependency is a Debian package; scripts/install-dependencies.sh installs them.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres 2.1 REQUIRED)  # brings glog::glog along
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs calib3d)
find_package(yaml-cpp REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
# Debian 12's libdeflate brings no CMake package.
find_path(LIBDEFLATE_INCLUDE_DIR libdeflate.h REQUIRED)
find_library(LIBDEFLATE_LIBRARY deflate REQUIRED)
add_library(libdeflate::libdeflate UNKNOWN IMPORTED)
set_target_properties(libdeflate::libdeflate PROPERTIES IMPORTED_LOCATION ${LIBDEFLATE_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${LIBDEFLATE_INCLUDE_DIR})
# GeographicLib's CMake files lie in different places on Debian 12 and Ubuntu 24.04.
find_path(GEOGRAPHICLIB_INCLUDE_DIR GeographicLib/SphericalHarmonic.hpp REQUIRED)
find_library(GEOGRAPHICLIB_LIBRARY NAMES GeographicLib Geographic REQUIRED)
add_library(geographiclib::geographiclib UNKNOWN IMPORTED)
set_target_properties(geographiclib::geographiclib PROPERTIES
                      IMPORTED_LOCATION ${GEOGRAPHICLIB_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${GEOGRAPHICLIB_INCLUDE_DIR})
find_package(nanoflann REQUIRED)
# Debian's cpp-httplib brings no CMake package on Debian 12.
find_path(HTTPLIB_INCLUDE_DIR httplib.h REQUIRED)
find_library(HTTPLIB_LIBRARY NAMES cpp-httplib REQUIRED)
add_library(httplib::httplib UNKNOWN IMPORTED)
set_target_properties(httplib::httplib PROPERTIES IMPORTED_LOCATION ${HTTPLIB_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${HTTPLIB_INCLUDE_DIR})
find_package(TBB REQUIRED COMPONENTS tbb)
# Embree 4 on Ubuntu 24.04, 3 on Debian 12.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3.12 REQUIRED)
endif()
if(NOT TARGET embree::embree)
  add_library(embree::embree ALIAS embree)
endif()
if(LODELINE_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(LODELINE_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
