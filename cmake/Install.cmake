# The library for other programs: find_package(lodeline), then link lodeline::estimator or another layer.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lodeline)
install(DIRECTORY src/lodeline DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
        FILES_MATCHING PATTERN "*.h" PATTERN "test_*.h" EXCLUDE)
install(EXPORT lodeline NAMESPACE lodeline:: FILE lodelineTargets.cmake DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/lodelineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/lodelineConfig.cmake cmake/Dependencies.cmake ${CMAKE_BINARY_DIR}/lodelineConfigVersion.cmake
        DESTINATION ${package_dir})
install(FILES LICENSE README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
