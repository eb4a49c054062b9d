# What programs that use lodeline::core link.
lodeline_find(Eigen3 3.4 NO_MODULE)
lodeline_find(Ceres 2.1)  # brings glog::glog along
lodeline_find(OpenCV 4.5 COMPONENTS core imgproc imgcodecs calib3d video)
lodeline_find(yaml-cpp)
lodeline_find(fmt)
lodeline_find(Threads)
lodeline_find(ZLIB)
lodeline_find(TBB COMPONENTS tbb)
# Debian 12's libdeflate brings no CMake package.
lodeline_find_library(libdeflate::libdeflate libdeflate.h deflate)
