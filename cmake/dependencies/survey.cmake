lodeline_find(PROJ 9 CONFIG)
lodeline_find(LibXml2)  # dive logs
# GeographicLib's CMake files lie in different places on Debian 12 and Ubuntu 24.04.
lodeline_find_library(geographiclib::geographiclib GeographicLib/LocalCartesian.hpp GeographicLib Geographic)
# GeoPackage and DXF, where GDAL is installed.
find_package(GDAL CONFIG QUIET)
