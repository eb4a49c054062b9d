# Debian's cpp-httplib brings no CMake package on Debian 12.
lodeline_find_library(httplib::httplib httplib.h cpp-httplib)
