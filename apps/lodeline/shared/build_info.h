#pragma once

namespace lodeline {

/// The sources and the configuration that the program was built from.
struct BuildInfo {
  const char* commit;  ///< with "-dirty" after it where files were changed; "unknown" outside of git
  const char* type;    ///< CMake's build type
};
BuildInfo buildInfo();

}  // namespace lodeline
