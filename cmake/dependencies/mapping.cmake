# What programs that use lodeline::mapping link.
lodeline_find(SQLite3)
# GeographicLib's CMake files lie in different places on Debian 12 and Ubuntu 24.04.
lodeline_find_library(geographiclib::geographiclib GeographicLib/LocalCartesian.hpp GeographicLib Geographic)
