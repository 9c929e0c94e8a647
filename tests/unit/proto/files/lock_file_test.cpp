#include "proto/files/lock_file.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <optional>
#include <string>
#include <utility>

#include "tests/support/temporary_directory.hpp"

namespace kinship::files::lock_file_test {
namespace {

/// Another process that does something, says so, and then waits to be killed.
class Child {
 public:
  /// \param work  returns what the process keeps as long as it lives.
  template <typename Work>
  explicit Child(Work work) {
    EXPECT_EQ(pipe(ends_.data()), 0);
    pid_ = fork();
    if (pid_ != 0)
      return;
    const auto kept = work();
    _exit(write(ends_[1], "x", 1) == 1 ? pause() : 1);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    close(ends_[0]);
    close(ends_[1]);
  }

  pid_t pid() const { return pid_; }
  /// Whether it has done its work; waits for that as long as `timeout_ms`, negative: for ever.
  bool is_done(int timeout_ms = -1) const {
    pollfd said{ends_[0], POLLIN, 0};
    return poll(&said, 1, timeout_ms) == 1;
  }

 private:
  std::array<int, 2> ends_{};
  pid_t pid_ = 0;
};

class LockFiles : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "lock";
};

TEST_F(LockFiles, AnotherProcessHoldsItUntilItIsKilled) {
  {
    const Child child([&] { return LockFile::try_acquire(file_); });
    ASSERT_TRUE(child.is_done());
    EXPECT_FALSE(LockFile::try_acquire(file_));
    EXPECT_EQ(LockFile::holder(file_), std::to_string(child.pid()));
  }
  EXPECT_TRUE(LockFile::try_acquire(file_));
}

TEST_F(LockFiles, OneOwnerHasItAtATimeInAProcessToo) {
  std::optional<LockFile> moved;
  {
    auto lock = LockFile::try_acquire(file_);
    ASSERT_TRUE(lock);
    EXPECT_FALSE(LockFile::try_acquire(file_));
    moved = *std::move(lock);
  }
  EXPECT_FALSE(LockFile::try_acquire(file_)) << "the lock moves with its object";
  moved = LockFile::acquire(directory_ / "other");
  EXPECT_TRUE(LockFile::try_acquire(file_));
}

TEST_F(LockFiles, ChildrenOfTheHolderThatRunOtherProgramsDoNotKeepIt) {
  auto lock = LockFile::try_acquire(file_);
  const pid_t child = fork();
  if (child == 0)
    _exit(execlp("sleep", "sleep", "60", nullptr));
  while (std::filesystem::read_symlink("/proc/" + std::to_string(child) + "/exe") ==
         std::filesystem::read_symlink("/proc/self/exe"))
    usleep(1000);
  lock.reset();
  EXPECT_TRUE(LockFile::try_acquire(file_));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST_F(LockFiles, WaitsForTheOneThatHasIt) {
  const auto acquire = [&] { return LockFile::acquire(file_); };
  std::optional<Child> holder(acquire);
  ASSERT_TRUE(holder->is_done());
  const Child waiting(acquire);
  EXPECT_FALSE(waiting.is_done(100));
  holder.reset();
  EXPECT_TRUE(waiting.is_done());
}

TEST_F(LockFiles, HasTheModeThatIsAskedForAndIsNoLink) {
  struct stat status {};
  static_cast<void>(LockFile::acquire(file_));
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  std::filesystem::create_symlink(file_, directory_ / "link");
  EXPECT_THROW(LockFile::acquire(directory_ / "link"), FileError);
}

TEST_F(LockFiles, SaysWhyItCannotBeMade) {
  try {
    static_cast<void>(LockFile::acquire("/proc/kinship/lock"));
    FAIL() << "a lock file in /proc";
  } catch (const FileError& error) {
    EXPECT_EQ(error.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(error.what()).find("'/proc/kinship/lock'"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::files::lock_file_test
