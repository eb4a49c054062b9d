# What `lodeline --version` says of the build. Included, it makes the library lodeline_build_info, whose only source is
# written anew at every build where the commit has changed. As a script it writes that source:
#   cmake -DSOURCE=FOLDER -DBUILD_TYPE=TYPE -DOUTPUT=FILE -P BuildInfo.cmake
if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(source ${CMAKE_BINARY_DIR}/build_info.cpp)
  add_custom_target(lodeline_write_build_info
    COMMAND ${CMAKE_COMMAND} -DSOURCE=${CMAKE_SOURCE_DIR} -DBUILD_TYPE=${CMAKE_BUILD_TYPE} -DOUTPUT=${source}
            -P ${CMAKE_CURRENT_LIST_FILE}
    BYPRODUCTS ${source} COMMENT "Asking git for the commit" VERBATIM)
  add_library(lodeline_build_info STATIC EXCLUDE_FROM_ALL ${source})
  target_link_libraries(lodeline_build_info PRIVATE lodeline_options)
  add_dependencies(lodeline_build_info lodeline_write_build_info)
  return()
endif()

set(commit unknown)
find_program(GIT git)
if(GIT)
  # A folder in the work tree of something else has no commit of its own.
  execute_process(COMMAND ${GIT} -C ${SOURCE} rev-parse --show-toplevel OUTPUT_VARIABLE top ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE)
  file(REAL_PATH ${SOURCE} source)
  if(top STREQUAL source)
    execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                    OUTPUT_VARIABLE described ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(described)
      set(commit ${described})
    endif()
  endif()
endif()
# The file is left as it is where nothing has changed, and nothing is built anew.
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#include "apps/lodeline/shared/build_info.h"

namespace lodeline {

BuildInfo buildInfo() { return {"@commit@", "@BUILD_TYPE@"}; }

}  // namespace lodeline
]])
