# Installs the build to a folder of its own; builds and runs programs there that use the library.
#   cmake -DBUILD=FOLDER -DSOURCE=FOLDER -DWORK=FOLDER -DPART=core|all [-DPYTHON=PROGRAM] -P install_test.cmake
function(run result)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
  set(${result} "${output}" PARENT_SCOPE)
endfunction()

# Configures the program `consumer` for a component that cannot be had, and looks for a message.
function(expect_refusal component regex)
  execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/cmake/tests/consumer -B ${WORK}/refused
                          -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCOMPONENT=${component}
                  RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  string(REGEX REPLACE "[ \n]+" " " output "${output}")
  if(code EQUAL 0 OR NOT output MATCHES "${regex}")
    message(FATAL_ERROR "component ${component} was not refused with '${regex}':\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(output ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
file(GLOB_RECURSE installed RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*)
file(GLOB_RECURSE public RELATIVE ${SOURCE}/include ${SOURCE}/include/*)
list(APPEND public lodeline/node/node_option.h lodeline/node/ros_session.h)
list(SORT public)
list(SORT installed)
if(NOT installed STREQUAL public)
  message(FATAL_ERROR "the installed headers are not those of include/: ${installed}")
endif()

if(PART STREQUAL core)
  # Packages that the core must do without.
  foreach(package embree PROJ LibXml2 BZip2 nlohmann_json Boost CLI11 nanoflann GTest benchmark)
    list(APPEND without -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  run(output ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/cmake/tests/consumer -B ${WORK}/build ${without}
      -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCOMPONENT=core
      -DSOURCE=${SOURCE}/examples/1_run_recording.cpp)
  run(output ${CMAKE_COMMAND} --build ${WORK}/build)
  run(output ${WORK}/build/consumer ${SOURCE}/samples/cave_dive 2)
  if(NOT output MATCHES "(^|\n)[1-9][0-9]* poses\n")
    message(FATAL_ERROR "no pose came out:\n${output}")
  endif()
  expect_refusal(sonar "there is no component 'sonar'; components are core, simulation, rosbag, survey, live")
  # As in an installation of a build without the component.
  file(READ ${WORK}/prefix/lib/cmake/lodeline/lodelineConfig.cmake config)
  string(REGEX REPLACE "set\\(lodeline_built [^)]*\\)" "set(lodeline_built core)" config "${config}")
  file(WRITE ${WORK}/prefix/lib/cmake/lodeline/lodelineConfig.cmake "${config}")
  expect_refusal(survey "component 'survey' was not built; this installation has core")
else()
  run(output ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/examples -B ${WORK}/build -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  run(output ${CMAKE_COMMAND} --build ${WORK}/build)
  run(output ${WORK}/build/example_4_evaluate)
  # The node of ROS 2 uses the library as this program does.
  run(output ${CMAKE_COMMAND} -G Ninja -S ${SOURCE}/cmake/tests/node_consumer -B ${WORK}/node -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  run(output ${CMAKE_COMMAND} --build ${WORK}/node)
  run(output ${WORK}/node/node_consumer)
  if(PYTHON)
    file(GLOB package ${WORK}/prefix/lib/python3*/dist-packages)
    run(output ${CMAKE_COMMAND} -E env PYTHONPATH=${package} ${PYTHON} -c "print(__import__('lodeline').__file__)")
    if(NOT output MATCHES "^${WORK}/prefix/")
      message(FATAL_ERROR "the installed Python module was not found: ${output}")
    endif()
  endif()
endif()
