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

# Pages for `man` and completion for shells, from the help texts of the program.
if(TARGET lodeline AND NOT CMAKE_CROSSCOMPILING)
  set(manual ${CMAKE_BINARY_DIR}/manual)
  set(bash_completion ${CMAKE_BINARY_DIR}/completion/lodeline)
  set(fish_completion ${CMAKE_BINARY_DIR}/completion/lodeline.fish)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/completion)
  add_custom_command(
    OUTPUT ${manual}/lodeline.1 ${bash_completion} ${fish_completion}
    COMMAND lodeline manual -o ${manual}
    COMMAND lodeline completion bash > ${bash_completion}
    COMMAND lodeline completion fish > ${fish_completion}
    DEPENDS lodeline VERBATIM)
  add_custom_target(lodeline_manual ALL DEPENDS ${manual}/lodeline.1)
  add_dependencies(lodeline_product lodeline_manual)
  install(DIRECTORY ${manual}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 FILES_MATCHING PATTERN "*.1")
  install(FILES ${bash_completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
  install(FILES ${fish_completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
endif()
