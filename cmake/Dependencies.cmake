# Every dependency is a Debian package; scripts/install-dependencies.sh installs them. cmake/dependencies/COMPONENT.cmake
# is read here and by find_package(lodeline COMPONENTS COMPONENT).

# lodeline_find(PACKAGE argument...): as find_package(), required by the component that is being read.
macro(lodeline_find package)
  find_package(${package} ${ARGN})
  if(NOT ${package}_FOUND)
    lodeline_refuse(${package})
  endif()
endmacro()

macro(lodeline_refuse package)
  set(advice "scripts/install-dependencies.sh build installs it")
  if(NOT component STREQUAL core)
    string(TOUPPER ${component} upper)
    string(APPEND advice "; -DLODELINE_WITH_${upper}=OFF builds without the component")
  endif()
  message(FATAL_ERROR "component '${component}' needs ${package}, which was not found: ${advice}")
endmacro()

include(cmake/FindLibrary.cmake)
foreach(component IN LISTS LODELINE_COMPONENTS)
  include(cmake/dependencies/${component}.cmake)
endforeach()

# Headers alone, which programs that use the library do not need.
set(component core)
lodeline_find(Boost 1.74 CONFIG)
lodeline_find(nlohmann_json)
if(LODELINE_WITH_SURVEY)
  lodeline_find(nanoflann)
endif()
if(LODELINE_BUILD_PROGRAM)
  lodeline_find(CLI11)
  # Dense walls, where Open3D is installed. Its own CMake package wants the windows of its viewer as well.
  find_path(OPEN3D_INCLUDE_DIR open3d/t/geometry/VoxelBlockGrid.h)
  find_library(OPEN3D_LIBRARY Open3D)
  if(OPEN3D_INCLUDE_DIR AND OPEN3D_LIBRARY)
    lodeline_find_library(open3d::open3d open3d/t/geometry/VoxelBlockGrid.h Open3D)
  endif()
endif()
if(LODELINE_BUILD_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()
if(LODELINE_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
