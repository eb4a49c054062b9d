# Every dependency is a Debian package; scripts/install-dependencies.sh installs them.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Boost 1.74 CONFIG REQUIRED)
find_package(Ceres 2.1 REQUIRED)  # brings glog::glog along
find_package(OpenCV 4.5 REQUIRED COMPONENTS core imgproc imgcodecs calib3d video)
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
find_package(PROJ 9 CONFIG REQUIRED)
find_package(LibXml2 REQUIRED)  # dive logs
find_package(nanoflann REQUIRED)
# Debian's cpp-httplib brings no CMake package on Debian 12.
find_path(HTTPLIB_INCLUDE_DIR httplib.h REQUIRED)
find_library(HTTPLIB_LIBRARY NAMES cpp-httplib REQUIRED)
add_library(httplib::httplib UNKNOWN IMPORTED)
set_target_properties(httplib::httplib PROPERTIES IMPORTED_LOCATION ${HTTPLIB_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${HTTPLIB_INCLUDE_DIR})
# ROS 1 bags: bzip2 and LZ4 to read them; to write them librosbag-storage, which may be missing.
find_package(BZip2 REQUIRED)
find_path(LZ4_INCLUDE_DIR lz4frame.h REQUIRED)
find_library(LZ4_LIBRARY lz4 REQUIRED)
add_library(lz4::lz4 UNKNOWN IMPORTED)
set_target_properties(lz4::lz4 PROPERTIES IMPORTED_LOCATION ${LZ4_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${LZ4_INCLUDE_DIR})
# Its CMake files ask for catkin; the packages that its headers take lie in folders of their own.
set(rosbag_libraries rosbag_storage roscpp_serialization rostime cpp_common console_bridge class_loader)
set(rosbag_headers rosbag/bag.h sensor_msgs/Imu.h pluginlib/class_loader.hpp class_loader/class_loader.hpp
    rcpputils/shared_library.hpp rcutils/types.h ament_index_cpp/get_package_prefix.hpp)
add_library(rosbag_storage::rosbag_storage INTERFACE IMPORTED)
set(LODELINE_HAS_ROSBAG_STORAGE ON)
foreach(library IN LISTS rosbag_libraries)
  find_library(ROSBAG_${library}_LIBRARY ${library})
  target_link_libraries(rosbag_storage::rosbag_storage INTERFACE ${ROSBAG_${library}_LIBRARY})
  if(NOT ROSBAG_${library}_LIBRARY)
    set(LODELINE_HAS_ROSBAG_STORAGE OFF)
  endif()
endforeach()
foreach(header IN LISTS rosbag_headers)
  string(REGEX REPLACE "/.*" "" package ${header})
  find_path(ROSBAG_${package}_INCLUDE_DIR ${header} PATH_SUFFIXES ${package})
  target_include_directories(rosbag_storage::rosbag_storage INTERFACE ${ROSBAG_${package}_INCLUDE_DIR})
  if(NOT ROSBAG_${package}_INCLUDE_DIR)
    set(LODELINE_HAS_ROSBAG_STORAGE OFF)
  endif()
endforeach()
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
