# What programs that use lodeline::node link beside the other components.
if(NOT TARGET glog::glog)
  lodeline_find(glog)
endif()
