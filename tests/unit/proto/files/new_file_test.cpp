#include "proto/files/new_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/full_disk.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

std::vector<std::string> calls;  // "sync <path>", "rename"
bool is_killed_at_rename = false;

long note_rename(long number, const char* from, const char* to, unsigned flags) {
  if (is_killed_at_rename)
    kill(getpid(), SIGKILL);
  calls.emplace_back("rename");
  return syscall(number, AT_FDCWD, from, AT_FDCWD, to, flags);
}

}  // namespace

// Calls of the system, seen on their way: the program's own definitions go before the C library's.
extern "C" {
int fsync(int descriptor) {
  calls.push_back("sync " +
                  std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(descriptor))
                      .filename()
                      .string());
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}
int rename(const char* from, const char* to) noexcept {
  return static_cast<int>(note_rename(SYS_renameat2, from, to, 0));
}
int renameat2(int /*from*/, const char* from, int /*to*/, const char* to, unsigned flags) noexcept {
  return static_cast<int>(note_rename(SYS_renameat2, from, to, flags));
}
}

namespace kinship::files::new_file_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSidecars[] = {"-wal", "-journal"};
constexpr NewFileOptions kExclusive{.magic = std::string_view("MAGIC\0", 6), .sidecars = kSidecars};
constexpr NewFileOptions kReplacing{.may_replace = true};

class NewFiles : public testing::Test {
 protected:
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name.c_str(), std::ios::binary) << text;
  }
  std::string content() const { return read_file(file_, 100); }
  mode_t mode_of(const fs::path& path) const {
    struct stat status {};
    return stat(path.c_str(), &status) == 0 ? status.st_mode & 0777U : 0;
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_.path()), {}));
  }
  static Error error_of(const std::function<void()>& use) {
    try {
      use();
    } catch (const Failure& failure) {
      return failure.error();
    }
    return {ErrorCode::Internal, "no failure"};
  }

  test::TemporaryDirectory directory_;
  const fs::path file_ = directory_ / "copy.db";
};

TEST_F(NewFiles, HaveTheirNameOnceTheyArePublished) {
  {
    NewFile file(file_);
    file.write("half ");
    EXPECT_TRUE(is_part(file.part()));
    EXPECT_FALSE(fs::exists(file_));
    file.write("and half");
    file.publish();
  }
  EXPECT_EQ(content(), "half and half");
  EXPECT_EQ(entries(), 1U);
  { NewFile(directory_ / "other").write("never published"); }
  EXPECT_EQ(entries(), 1U);
}

TEST_F(NewFiles, AKilledWriterLeavesTheOldFile) {
  put("copy.db", "old");
  const pid_t child = fork();
  if (child == 0) {
    is_killed_at_rename = true;
    write_file(file_, "new", kReplacing);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(entries(), 2U) << "the part of the killed process";
  write_file(file_, "new", kReplacing);
  EXPECT_EQ(content(), "new");
}

TEST_F(NewFiles, AreDurableBeforeTheyHaveTheirNameAndTheNameIsThen) {
  NewFile file(file_);
  calls.clear();
  file.publish();
  EXPECT_EQ(calls, (std::vector<std::string>{"sync " + file.part().filename().string(), "rename",
                                             "sync " + directory_.path().filename().string()}));
  calls.clear();
  write_file(file_, "text", {.may_replace = true, .is_durable = false});
  EXPECT_EQ(calls, std::vector<std::string>{"rename"});
}

TEST_F(NewFiles, HaveTheModeThatIsAskedForFromTheBeginning) {
  put("copy.db", "for all");
  NewFile secret(file_, kReplacing);
  EXPECT_EQ(mode_of(secret.part()), 0600U);
  secret.publish();
  EXPECT_EQ(mode_of(file_), 0600U);
  write_file(file_, "text", {.mode = 0644, .may_replace = true});
  EXPECT_EQ(mode_of(file_), 0644U);
}

TEST_F(NewFiles, ReplaceNothingUnlessTheyMay) {
  NewFile late(file_);
  put("copy.db", "old");
  const Error there = error_of([&] { const NewFile file(file_); });
  EXPECT_EQ(there.code, ErrorCode::Conflict);
  EXPECT_EQ(there.message, "file '" + file_.string() + "': is there already");
  EXPECT_EQ(error_of([&] { late.publish(); }).code, ErrorCode::Conflict);
  EXPECT_EQ(content(), "old");
}

TEST_F(NewFiles, AFullDiskLeavesNothingOfThem) {
  put("copy.db", "old");
  {
    const test::FullDisk full(10);
    const std::string text(100, 'x');
    const Error error = error_of([&] { write_file(directory_ / "other", text, {}); });
    EXPECT_EQ(error.code, ErrorCode::Storage);
    EXPECT_EQ(error.message,
              "file '" + (directory_ / "other").string() + "': cannot be written: File too large");
    EXPECT_THROW(write_file(file_, text, kReplacing), FileError);
  }
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(entries(), 1U);
}

TEST_F(NewFiles, TimesOfWritingAreInTheirOrder) {
  std::vector<fs::path> files;
  for (int i = 0; i < 20; ++i)
    write_file(files.emplace_back(directory_.path() / std::to_string(i)), "text",
               {.is_durable = false});
  const auto are_not_in_order = [](const fs::path& one, const fs::path& next) {
    return fs::last_write_time(one) >= fs::last_write_time(next);
  };
  EXPECT_EQ(std::ranges::adjacent_find(files, are_not_in_order), files.end());
}

TEST_F(NewFiles, WhatSomebodyElseHasStays) {
  put("copy.db.part", "somebody's");
  put("copy.db.kinship-0123abcd.part", "not of this kind, whatever its name says");
  put("copy.db.kinship-0123abcd.part.txt.part", "");
  put("other.db.kinship-0123abcd.part", "");
  {
    const NewFile file(file_, kExclusive);
    EXPECT_TRUE(fs::exists(file.part()));
    EXPECT_EQ(entries(), 5U);
  }
  EXPECT_EQ(entries(), 4U);
}

TEST_F(NewFiles, WhatAKilledProcessLeftGoes) {
  put("copy.db.kinship-0123abcd.part", "");
  put("copy.db.kinship-11111111.part", std::string("MAGIC\0 and pages", 16));
  put("copy.db.kinship-11111111.part-journal", "of it");
  put("copy.db.kinship-22222222.part-journal", "of one that is gone");
  NewFile file(file_, kExclusive);
  EXPECT_EQ(entries(), 1U);
  file.publish();
  EXPECT_TRUE(fs::exists(file_));
  EXPECT_EQ(entries(), 1U);
}

TEST_F(NewFiles, TakeTheirSidecarsAlongUnlessTheyArePublished) {
  {
    const NewFile file(file_, kExclusive);
    put(file.part().filename().string() + "-wal", "");
  }
  EXPECT_EQ(entries(), 0U);
}

TEST_F(NewFiles, OnlyOneWritesAFileAtATime) {
  const NewFile first(file_, kExclusive);
  const Error error = error_of([&] { const NewFile second(file_, kExclusive); });
  EXPECT_EQ(error.code, ErrorCode::Conflict);
  EXPECT_EQ(error.message, "file '" + file_.string() + "': somebody else is writing it");
  EXPECT_TRUE(fs::exists(first.part()));
}

TEST_F(NewFiles, AreNamedInMessagesAndTooLongOnesAreNotRead) {
  const fs::path lost = directory_ / "nowhere" / "file";
  EXPECT_EQ(error_of([&] { write_file(lost, "", {}); }).message,
            "file '" + lost.string() + "': cannot be made: No such file or directory");
  EXPECT_EQ(error_of([&] { read_file(lost, 10); }).message,
            "file '" + lost.string() + "': cannot be opened: No such file or directory");
  put("copy.db", std::string(11, 'x'));
  EXPECT_EQ(read_file(file_, 11).size(), 11U);
  const Error error = error_of([&] { read_file(file_, 10); });
  EXPECT_EQ(error.code, ErrorCode::TooLarge);
  EXPECT_EQ(error.message, file_.string() + ": exceeds 10 bytes");
}

}  // namespace
}  // namespace kinship::files::new_file_test
