# The ray tracer. Embree 4 on Ubuntu 24.04, 3 on Debian 12.
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  lodeline_find(embree 3.12)
endif()
if(NOT TARGET embree::embree)
  add_library(embree::embree ALIAS embree)
endif()
