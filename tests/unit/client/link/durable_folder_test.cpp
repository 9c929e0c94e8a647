// What is synced to disk, seen at the call of the system: fsync() of this program is the one below.

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

#include "client/link/durable_file.hpp"
#include "client/link/outbox.hpp"
#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/client/link/another_user.hpp"

namespace {

std::mutex mutex;
std::set<std::filesystem::path> synced;  // guarded by mutex

}  // namespace

extern "C" int fsync(int descriptor) {
  std::error_code error;
  const auto path =
      std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error);
  const std::lock_guard lock(mutex);
  synced.insert(path);
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

namespace kinship::link::durable_folder_test {
namespace {

class DurableFolder : public testing::Test {
 protected:
  DurableFolder() { forget(); }
  static void forget() {
    const std::lock_guard lock(mutex);
    synced.clear();
  }
  static bool is_synced(const std::filesystem::path& path) {
    const std::lock_guard lock(mutex);
    return synced.contains(path);
  }
  test::TemporaryDirectory directory;
  const std::filesystem::path folder = std::filesystem::canonical(directory.path());
};

TEST_F(DurableFolder, EveryFolderThatGotANewOneIsSynced) {
  const Outbox outbox(folder / "state" / "kinship" / "outbox");
  EXPECT_TRUE(is_synced(folder));
  EXPECT_TRUE(is_synced(folder / "state"));
  EXPECT_TRUE(is_synced(folder / "state" / "kinship"));
  EXPECT_TRUE(is_synced(folder / "state" / "kinship" / "outbox"));
}

TEST_F(DurableFolder, FoldersThatAreThereAreLeftAlone) {
  make_folder_durably(folder / "a");
  forget();
  make_folder_durably(folder / "a" / "");
  make_folder_durably(folder / "a");
  EXPECT_FALSE(is_synced(folder));
}

TEST_F(DurableFolder, ItIsSyncedWhenItGetsADurableFile) {
  write_whole(folder / "mark", "text");
  EXPECT_FALSE(is_synced(folder));
  write_durably(folder / "report", "text");
  EXPECT_TRUE(is_synced(folder));
}

std::string said_of(int reason) {
  try {
    errno = reason;
    fail_on("/home/u/.local", "cannot make the folder");
  } catch (const Failure& failure) {
    return failure.what();
  }
}

TEST_F(DurableFolder, APlaceThatCannotBeWrittenIsToldWithWhatToName) {
  EXPECT_EQ(said_of(EROFS),
            "/home/u/.local: cannot make the folder: Read-only file system; name a folder for "
            "reports that can be written (--outbox FOLDER; in Python Client(outbox=...); in C "
            "kinship_client_options.outbox), or set XDG_STATE_HOME to one");
  EXPECT_NE(said_of(EACCES).find("; name a folder"), std::string::npos);
  EXPECT_EQ(said_of(ENOSPC), "/home/u/.local: cannot make the folder: No space left on device");
}

TEST_F(DurableFolder, AFileThatCannotBeReadIsToldWithoutAPlaceToWrite) {
  write_durably(folder / "file", "text");
  std::filesystem::permissions(folder / "file", std::filesystem::perms::none);
  const auto said = [&](const auto& use) {
    const AnotherUser user;
    if (AnotherUser::is_root())
      return std::string("root");
    try {
      use();
    } catch (const Failure& failure) {
      return std::string(failure.what());
    }
    return std::string("nothing");
  };
  const std::string of_reading = said([&] { read_file(folder / "file", 100); });
  if (of_reading == "root")
    GTEST_SKIP() << "root that must not become another user";
  EXPECT_EQ(of_reading, (folder / "file").string() + ": cannot open: Permission denied");
  std::filesystem::permissions(folder, std::filesystem::perms::owner_read);
  const std::string of_writing = said([&] { write_whole(folder / "other", "text"); });
  std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
  EXPECT_NE(of_writing.find(": cannot open: Permission denied; name a folder"), std::string::npos)
      << of_writing;
}

TEST_F(DurableFolder, FileInTheWayIsNamed) {
  write_durably(folder / "file", "");
  try {
    make_folder_durably(folder / "file" / "a");
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("file"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::link::durable_folder_test
