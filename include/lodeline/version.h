#pragma once

/// Version of the library, for the preprocessor. CMake reads it from here.
#define LODELINE_VERSION_MAJOR 0
#define LODELINE_VERSION_MINOR 1
#define LODELINE_VERSION_PATCH 0
#define LODELINE_VERSION "0.1.0"
