# The library for other programs: find_package(lodeline COMPONENTS core ...), then link lodeline::core and the like.
# Public headers are those of include/; all others stay here.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodeline)
install(DIRECTORY include/lodeline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
if(node IN_LIST LODELINE_COMPONENTS)  # for the node of ROS 2, which is built elsewhere
  install(FILES src/lodeline/node/node_option.h src/lodeline/node/ros_session.h
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/lodeline/node)
endif()
foreach(component IN LISTS LODELINE_ALL_COMPONENTS)
  if(NOT component IN_LIST LODELINE_COMPONENTS)
    continue()
  endif()
  install(EXPORT lodeline_${component} NAMESPACE lodeline:: FILE lodeline_${component}.cmake DESTINATION ${package_dir})
  install(FILES cmake/dependencies/${component}.cmake DESTINATION ${package_dir}/dependencies)
endforeach()
configure_package_config_file(cmake/lodelineConfig.cmake.in ${CMAKE_BINARY_DIR}/lodelineConfig.cmake
                              INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO
                              NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lodelineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/lodelineConfig.cmake ${CMAKE_BINARY_DIR}/lodelineConfigVersion.cmake
              cmake/FindLibrary.cmake DESTINATION ${package_dir})
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
