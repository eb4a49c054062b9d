# Writes the source of lodeline_build_info outside of git, in a work tree of git, and in a folder of that tree.
#   cmake -DWORK=FOLDER -DSCRIPT=cmake/BuildInfo.cmake -P build_info_test.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}: ${output}")
  endif()
endfunction()

function(expect folder regex)
  run(${CMAKE_COMMAND} -DSOURCE=${folder} -DBUILD_TYPE=Debug -DOUTPUT=${WORK}/info.cpp -P ${SCRIPT})
  file(READ ${WORK}/info.cpp text)
  if(NOT text MATCHES "return {\"${regex}\", \"Debug\"}")
    message(FATAL_ERROR "build info of ${folder} is not ${regex}:\n${text}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/tree/inside)
# The build folder may lie in a work tree itself.
set(ENV{GIT_CEILING_DIRECTORIES} ${WORK})
expect(${WORK}/tree unknown)

file(WRITE ${WORK}/tree/file.txt "as committed\n")
set(git git -C ${WORK}/tree -c user.name=test -c user.email=test@localhost -c commit.gpgsign=false)
run(${git} init -q)
run(${git} add file.txt)
run(${git} commit -q -m first)
expect(${WORK}/tree "[0-9a-f]+")
expect(${WORK}/tree/inside unknown)

file(TIMESTAMP ${WORK}/info.cpp before "%s" UTC)
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1.1)
expect(${WORK}/tree/inside unknown)
file(TIMESTAMP ${WORK}/info.cpp after "%s" UTC)
if(NOT before EQUAL after)
  message(FATAL_ERROR "the source was written anew although nothing has changed")
endif()

file(WRITE ${WORK}/tree/file.txt "changed\n")
expect(${WORK}/tree "[0-9a-f]+-dirty")
