# What is installed: everything but tests, benchmarks and studies.
add_custom_target(lodeline_product)

# Makes a layer part of the installed library where a component contains it.
function(lodeline_export name)
  get_target_property(kind lodeline_${name} TYPE)
  if(NOT kind STREQUAL INTERFACE_LIBRARY)
    add_dependencies(lodeline_product lodeline_${name})
  endif()
  foreach(component IN LISTS LODELINE_COMPONENTS)
    if(name IN_LIST LODELINE_${component}_LAYERS)
      set_target_properties(lodeline_${name} PROPERTIES EXPORT_NAME layer_${name})
      install(TARGETS lodeline_${name} EXPORT lodeline_${component})
    endif()
  endforeach()
endfunction()

# What every target of the project is compiled with.
add_library(lodeline_options INTERFACE)
target_compile_features(lodeline_options INTERFACE cxx_std_20)
target_compile_options(lodeline_options INTERFACE $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic>)
if(LODELINE_WARNINGS_AS_ERRORS)
  target_compile_options(lodeline_options INTERFACE $<BUILD_INTERFACE:-Werror>)
endif()
target_include_directories(lodeline_options INTERFACE $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include>
                                                      $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src>
                                                      $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}>
                                                      $<INSTALL_INTERFACE:include>)
if(LODELINE_BUILD_PYTHON)
  # The Python module contains the static libraries, so these are compiled for it, with the headers parsed for them.
  # With the second flag, calls within a file are as fast as without the first: nothing replaces a function of the
  # module. The property POSITION_INDEPENDENT_CODE would mean other flags in programs.
  set(is_in_module $<OR:$<STREQUAL:$<TARGET_PROPERTY:TYPE>,STATIC_LIBRARY>,$<BOOL:$<TARGET_PROPERTY:LODELINE_IN_MODULE>>>)
  target_compile_options(lodeline_options
                         INTERFACE $<BUILD_INTERFACE:$<${is_in_module}:-fPIC$<SEMICOLON>-fno-semantic-interposition>>)
endif()
if(LODELINE_SANITIZERS)
  # Checks of every reference for null and alignment take nearly half of the time to compile. The address sanitizer stops
  # at the first use of a null pointer, and Eigen asserts the alignment of what it maps.
  target_compile_options(lodeline_options INTERFACE -fsanitize=${LODELINE_SANITIZERS} -fno-sanitize=null,alignment
                                                    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(lodeline_options INTERFACE -fsanitize=${LODELINE_SANITIZERS})
endif()
lodeline_export(options)

# The .cpp files of a layer's folder and FOLDERS whose names match a regular expression.
function(lodeline_files result regex)
  set(found)
  set(folders ${ARGN})
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND found ${files})
  endforeach()
  list(FILTER found INCLUDE REGEX ${regex})
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# lodeline_layer(NAME [FOLDERS ...] [DEPENDS layer-or-library ...] [EXCLUDE ...] [TEST_FOLDERS ...] [TEST_SOURCES ...]
#                [ALONE ...])
#
# One layer of the library: target lodeline_NAME (an interface library when it has no sources), linked against lower
# layers (by layer name) and outside libraries (by target name). It is made of all .cpp files in the folder of its
# CMakeLists.txt and in FOLDERS. These are listed from the bottom up ("." is the folder itself, without it the topmost).
# The name of a file decides its kind:
#
#   *_real_test.cpp     tests that read recordings, and skip themselves where these are missing
#   *_browser_test.cpp, *_benchmark.cpp, main.cpp     no part of the layer
#   *_test.cpp          fast tests, which need no data and run under the sanitizers too
#   test_*.cpp          helpers of both kinds of tests
#
# TEST_FOLDERS hold tests and helpers only. TEST_SOURCES are helpers from elsewhere. EXCLUDE are names to leave out.
# ALONE are files that a build of several files at a time leaves to themselves: local names of theirs are those of
# their neighbours, or they take as long as a dozen others.
function(lodeline_layer name)
  cmake_parse_arguments(ARG "" "" "FOLDERS;DEPENDS;EXCLUDE;TEST_FOLDERS;TEST_SOURCES;ALONE" ${ARGN})
  lodeline_files(sources ".*" . ${ARG_FOLDERS})
  list(FILTER sources EXCLUDE REGEX "(/test_[a-z0-9_]+|_test|_benchmark|/main)\\.cpp$")
  foreach(excluded IN LISTS ARG_EXCLUDE)
    list(FILTER sources EXCLUDE REGEX "/${excluded}$")
  endforeach()
  set(test_folders . ${ARG_FOLDERS} ${ARG_TEST_FOLDERS})
  lodeline_files(helpers "/test_[a-z0-9_]+\\.cpp$" ${test_folders})
  list(FILTER helpers EXCLUDE REGEX "_test\\.cpp$")
  foreach(excluded IN LISTS ARG_EXCLUDE)
    list(FILTER helpers EXCLUDE REGEX "/${excluded}$")
  endforeach()
  lodeline_files(tests "_test\\.cpp$" ${test_folders})
  set(real_tests ${tests})
  list(FILTER real_tests INCLUDE REGEX "_real_test\\.cpp$")
  list(FILTER tests EXCLUDE REGEX "(_real|browser)_test\\.cpp$")
  set(all_files ${sources} ${tests} ${real_tests})
  foreach(alone IN LISTS ARG_ALONE)
    set(place ${all_files})
    list(FILTER place INCLUDE REGEX "/${alone}$")
    if(NOT place)
      message(FATAL_ERROR "layer '${name}' has no file '${alone}' to compile alone")
    endif()
    set_source_files_properties(${place} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endforeach()
  set(links)
  foreach(dependency IN LISTS ARG_DEPENDS)
    if(TARGET lodeline_${dependency})
      list(APPEND links lodeline_${dependency})
    elseif(dependency MATCHES "^[a-z0-9]+$")
      message(FATAL_ERROR "layer '${name}' depends on '${dependency}', which is not below it")
    elseif(dependency MATCHES "^(Boost::headers|nlohmann_json::.*|nanoflann::.*|CLI11::.*)$")
      # Headers alone, which no public header includes.
      list(APPEND links $<BUILD_INTERFACE:${dependency}>)
    else()
      list(APPEND links ${dependency})
    endif()
  endforeach()
  if(sources)
    add_library(lodeline_${name} STATIC ${sources})
    target_link_libraries(lodeline_${name} PUBLIC lodeline_options ${links})
    if("CLI11::CLI11" IN_LIST ARG_DEPENDS)
      lodeline_use_precompiled(lodeline_${name} commands)
    else()
      lodeline_use_precompiled(lodeline_${name} library)
    endif()
  else()
    add_library(lodeline_${name} INTERFACE)
    target_link_libraries(lodeline_${name} INTERFACE lodeline_options ${links})
  endif()
  lodeline_export(${name})
  if(NOT LODELINE_BUILD_TESTS)
    return()
  endif()
  if(tests)
    lodeline_test(${name}_test fast ${name} ${tests} ${helpers} ${ARG_TEST_SOURCES})
  endif()
  if(real_tests)
    lodeline_test(${name}_real_test real ${name} ${real_tests} ${helpers} ${ARG_TEST_SOURCES})
  endif()
endfunction()

# Tests of recordings are named one by one, since each may have to be skipped. The rest, a thousand, share processes: loading the
# libraries takes a process longer than most tests take it, and a quarter of the time of all. Several processes each, since
# they run beside each other.
function(lodeline_test target label layer)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE lodeline_${layer} lodeline_test_data lodeline_test_main GTest::gtest
                                          GTest::gmock)
  lodeline_use_precompiled(${target} tests)
  if(label STREQUAL real)
    gtest_discover_tests(${target} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
                         PROPERTIES LABELS ${label} TIMEOUT 600)
    return()
  endif()
  foreach(shard RANGE 3)
    add_test(NAME ${target}.${shard} COMMAND ${target})
    set_tests_properties(
      ${target}.${shard} PROPERTIES LABELS ${label} TIMEOUT 1200
                                    ENVIRONMENT "GTEST_TOTAL_SHARDS=4;GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

# lodeline_benchmark(NAME SOURCE... DEPENDS layer...): an executable that `make bench` runs.
function(lodeline_benchmark name)
  if(NOT LODELINE_BUILD_BENCHMARKS)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  list(TRANSFORM ARG_DEPENDS PREPEND lodeline_)
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} benchmark::benchmark_main)
endfunction()
