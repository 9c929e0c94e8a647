#include "proto/security/private_files.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <string>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::security {
namespace {

/// As if the disk were full behind some bytes of a file.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

std::size_t count_files(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder))
    ++count;
  return count;
}

TEST(PrivateFiles, AFullDiskLeavesNoHalfOfThem) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path old_one = folder / "old";
  write_new_file(old_one, "before", Readers::Owner);
  {
    const FullDisk full(10);
    EXPECT_THROW(write_new_file(folder / "new", std::string(100, 'x'), Readers::Owner), Failure);
    EXPECT_THROW(replace_file(old_one, std::string(100, 'x'), Readers::Owner), Failure);
  }
  EXPECT_EQ(read_file(old_one), "before");
  EXPECT_EQ(count_files(folder.path()), 1U) << "the name is free";
  write_new_file(folder / "new", "after all", Readers::Owner);
  EXPECT_EQ(read_file(folder / "new"), "after all");
}

}  // namespace
}  // namespace kinship::security
