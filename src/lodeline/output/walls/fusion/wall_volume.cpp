#include "lodeline/output/walls/fusion/wall_volume.h"

#include <dlfcn.h>
#include <fmt/core.h>

#include <filesystem>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// The module beside the program, as it is built, or in lib beside bin, as it is installed.
fs::path moduleFile() {
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  const fs::path built = bin / "lodeline_open3d.so";
  return fs::exists(built, error)
             ? built
             : (bin / LODELINE_LIB_FROM_BIN / "lodeline/lodeline_open3d.so").lexically_normal();
}

MakeWallVolume& loadModule() {
  const fs::path file = moduleFile();
  void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = module != nullptr ? ::dlsym(module, "lodelineMakeWallVolume") : nullptr;
  if (function == nullptr)
    throw UsageError(
        fmt::format("the module with Open3D, which fuses depths to walls, cannot be loaded ({}); build with "
                    "libopen3d-dev",
                    ::dlerror()));
  return *reinterpret_cast<MakeWallVolume*>(function);
}

}  // namespace

MakeWallVolume& wallVolumeModule() {
  static MakeWallVolume& make = loadModule();
  return make;
}

}  // namespace lodeline
