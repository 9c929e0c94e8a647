// A backup for which there is no room, or no more while it is written: a folder of backups that is
// a small file system of its own.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/integration/admin_commands.hpp"
#include "tests/integration/incompressible_paths.hpp"
#include "tests/support/small_file_system.hpp"

namespace kinship::full_disk_backup_test {
namespace {

namespace fs = std::filesystem;
using admin_commands_test::Answer;
using admin_commands_test::expect_has;
using admin_commands_test::Server;
using test::SmallFileSystem;

class FullDiskBackup : public testing::Test {
 protected:
  static fs::path made(const fs::path& folder) {
    fs::create_directory(folder);
    return folder;
  }
  void SetUp() override {
    if (!disk_.is_mounted())
      GTEST_SKIP() << "no small file system can be mounted here: " << disk_.why();
  }

  const test::TemporaryDirectory folder_;
  const fs::path backups_ = made(folder_ / "backups");
  const SmallFileSystem disk_{backups_, "2m"};
};

std::string number_after(const std::string& words, const std::string& in) {
  const std::size_t at = in.find(words);
  if (at == std::string::npos)
    return "";
  const std::size_t begin = at + words.size();
  return in.substr(begin, in.find_first_not_of("0123456789", begin) - begin);
}

TEST_F(FullDiskBackup, IsRefusedOrFailsInWordsAndLeavesNothing) {
  const Server server(folder_ / "fleet.db", {"--backup-folder", backups_.string()});
  test::report_incompressible_paths(*server.client(folder_ / "outbox"), 8);
  const Answer refused = server.kinship("backup monday.db");
  EXPECT_NE(refused.code, 0);
  for (const char* const part :
       {"monday.db': needs up to ", "but its file system has 2097152 left"})
    expect_has(refused.err, part);
  EXPECT_EQ(disk_.names(), "");

  // Enough for the copy by the look before, and not for what SQLite lays beside it.
  const std::string needed = number_after("needs up to ", refused.err);
  disk_.resize(needed);
  const Answer failed = server.kinship("backup monday.db");
  EXPECT_NE(failed.code, 0);
  const std::string said = failed.out + failed.err;
  for (const char* const part : {"monday.db': ", "No space left on device"})
    expect_has(said, part);
  EXPECT_EQ(disk_.names(), "");
  EXPECT_EQ(server.kinship("backup list").out, "(none)\n");
  EXPECT_NE(server.kinship("status").out.find("writable       yes"), std::string::npos);

  disk_.resize("40m");
  EXPECT_EQ(server.kinship("backup monday.db").code, 0) << "its name is free";
  EXPECT_EQ(disk_.names(), " monday.db");
}

}  // namespace
}  // namespace kinship::full_disk_backup_test
