# Read by find_package(lodeline).
include(${CMAKE_CURRENT_LIST_DIR}/Dependencies.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/lodelineTargets.cmake)
