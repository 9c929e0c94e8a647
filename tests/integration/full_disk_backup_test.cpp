// A backup for which there is no room, or no more while it is written: a folder of backups that is
// a small file system of its own.

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "tests/integration/admin_commands.hpp"
#include "tests/integration/incompressible_paths.hpp"

namespace kinship::full_disk_backup_test {
namespace {

namespace fs = std::filesystem;
using admin_commands_test::Answer;
using admin_commands_test::Server;

/// In a mount namespace that this thread and the processes it starts share: nobody else sees it,
/// and it goes with them.
class SmallFileSystem {
 public:
  SmallFileSystem(fs::path folder, const std::string& size) : folder_(std::move(folder)) {
    if (unshare(CLONE_NEWNS) == 0 &&
        mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
        mount("tmpfs", folder_.c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0)
      is_mounted_ = true;
    else
      why_ = std::strerror(errno);
  }
  SmallFileSystem(const SmallFileSystem&) = delete;
  SmallFileSystem& operator=(const SmallFileSystem&) = delete;
  ~SmallFileSystem() {
    if (is_mounted_)
      umount2(folder_.c_str(), MNT_DETACH);
  }

  bool is_mounted() const { return is_mounted_; }
  const std::string& why() const { return why_; }  ///< it is not

  void resize(const std::string& size) const {
    ASSERT_EQ(mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT, ("size=" + size).c_str()), 0);
  }
  /// Names of all that is there, each after a space.
  std::string names() const {
    std::string names;
    for (const auto& entry : fs::directory_iterator(folder_))
      names += ' ' + entry.path().filename().string();
    return names;
  }

 private:
  fs::path folder_;
  bool is_mounted_ = false;
  std::string why_;
};

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
  const Answer refused = server.kinship({"backup", "monday.db"});
  EXPECT_NE(refused.code, 0);
  for (const char* const part :
       {"monday.db': needs up to ", "but its file system has 2097152 left"})
    EXPECT_NE(refused.err.find(part), std::string::npos) << refused.err;
  EXPECT_EQ(disk_.names(), "");

  // Enough for the copy by the look before, and not for what SQLite lays beside it.
  const std::string needed = number_after("needs up to ", refused.err);
  disk_.resize(needed);
  const Answer failed = server.kinship({"backup", "monday.db"});
  EXPECT_NE(failed.code, 0);
  const std::string said = failed.out + failed.err;
  for (const char* const part : {"monday.db': ", "No space left on device"})
    EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_EQ(disk_.names(), "");
  EXPECT_EQ(server.kinship({"backup", "list"}).out, "(none)\n");
  EXPECT_NE(server.kinship({"status"}).out.find("writable       yes"), std::string::npos);

  disk_.resize("40m");
  EXPECT_EQ(server.kinship({"backup", "monday.db"}).code, 0) << "its name is free";
  EXPECT_EQ(disk_.names(), " monday.db");
}

}  // namespace
}  // namespace kinship::full_disk_backup_test
