# What programs that use lodeline::core link.
lodeline_find(Eigen3 3.4 NO_MODULE)
lodeline_find(Ceres 2.1)  # brings glog::glog along
lodeline_find(yaml-cpp)
lodeline_find(fmt)
lodeline_find(Threads)
lodeline_find(ZLIB)
lodeline_find(TBB COMPONENTS tbb)
lodeline_find(apriltag)
# Debian 12's libdeflate brings no CMake package.
lodeline_find_library(libdeflate::libdeflate libdeflate.h deflate)
# OpenCV's CMake package wants all modules with all that they depend on; Debian's packages of these six will do.
find_package(OpenCV 4.5 QUIET COMPONENTS core imgproc imgcodecs calib3d video features2d)
if(NOT OpenCV_FOUND)
  foreach(module core imgproc imgcodecs calib3d video features2d)
    lodeline_find_library(opencv_${module} opencv2/${module}.hpp opencv_${module})
  endforeach()
endif()
