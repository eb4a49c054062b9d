# Outside headers that most files include, parsed once for all files instead of once for each: a quarter of the time to
# build everything. Files include what they use all the same; built without this (as for coverage), they prove it.
option(LODELINE_PRECOMPILED_HEADERS "Parse the headers that most files include once for all" ON)

set(precompiled_headers
    <algorithm> <array> <cmath> <filesystem> <fstream> <functional> <map> <memory> <optional> <random> <sstream>
    <string> <vector> <Eigen/Dense> <fmt/format.h> <opencv2/core.hpp>
    ${CMAKE_SOURCE_DIR}/src/lodeline/util/build/decompositions.h)

# lodeline_precompile(NAME HEADER... LINKS library... [FOR_PROGRAMS]): target lodeline_precompiled_NAME, which holds the
# parsed headers and those named here. FOR_PROGRAMS: for programs and not for libraries, whose flags may differ.
function(lodeline_precompile name)
  cmake_parse_arguments(ARG "FOR_PROGRAMS" "" "LINKS" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/precompiled_${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(lodeline_precompiled_${name} OBJECT ${source})
  target_link_libraries(lodeline_precompiled_${name} PRIVATE lodeline_options fmt::fmt Eigen3::Eigen opencv_core
                                                             ${ARG_LINKS})
  if(NOT ARG_FOR_PROGRAMS)
    set_target_properties(lodeline_precompiled_${name} PROPERTIES LODELINE_IN_MODULE ON)
  endif()
  target_precompile_headers(lodeline_precompiled_${name} PRIVATE ${precompiled_headers} ${ARG_UNPARSED_ARGUMENTS})
endfunction()

if(LODELINE_PRECOMPILED_HEADERS)
  lodeline_precompile(library)
  if(LODELINE_BUILD_PROGRAM)
    lodeline_precompile(commands <CLI/CLI.hpp> LINKS CLI11::CLI11)
    if(LODELINE_BUILD_TESTS)
      lodeline_precompile(studies <CLI/CLI.hpp> LINKS CLI11::CLI11 FOR_PROGRAMS)
    endif()
  endif()
  if(LODELINE_BUILD_TESTS)
    lodeline_precompile(tests <gmock/gmock.h> <gtest/gtest.h> LINKS GTest::gtest FOR_PROGRAMS)
  endif()
endif()

# Compiles a target with the headers of one of the sets above.
function(lodeline_use_precompiled target name)
  if(LODELINE_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM lodeline_precompiled_${name})
  endif()
endfunction()
