#include "lodeline/util/files/folder_lock.h"

#include <gmock/gmock.h>

#include <optional>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

TEST(FolderLock, OneWriterAtATime) {
  const fs::path folder = fs::path(testing::TempDir()) / "lodeline_folder_lock_test";
  fs::create_directories(folder);
  std::optional<FolderLock> first;
  first.emplace(folder);
  try {
    const FolderLock second(folder);
    ADD_FAILURE() << "two writers";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(folder.string()));
    EXPECT_THAT(error.what(), testing::HasSubstr("another run is writing to it"));
  }
  first.reset();
  EXPECT_NO_THROW(FolderLock{folder});
  fs::remove_all(folder);
}

}  // namespace
}  // namespace lodeline
