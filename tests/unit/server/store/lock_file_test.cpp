#include "server/store/sqlite/files/lock_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::lock_file_test {
namespace {

/// What another process says when it wants the lock; empty: it got it.
std::string refusal_of_a_child(const std::filesystem::path& file) {
  int ends[2] = {};
  if (pipe(ends) != 0)
    return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    std::string said;
    try {
      const LockFile lock(file);
    } catch (const Failure& failure) {
      said = failure.code() == ErrorCode::Unavailable ? failure.what() : "another failure";
    }
    _exit(write(ends[1], said.data(), said.size()) < 0 ? 1 : 0);
  }
  close(ends[1]);
  std::string said(4096, '\0');
  const ssize_t size = read(ends[0], said.data(), said.size());
  said.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return said;
}

TEST(LockFile, RefusesASecondProcessAndNamesTheFirst) {
  const test::TemporaryDirectory directory;
  const LockFile lock(directory / "s.db");
  const std::string said = refusal_of_a_child(directory / "s.db");
  EXPECT_NE(said.find("process " + std::to_string(getpid())), std::string::npos) << said;
}

TEST(LockFile, EndsWithItsHolder) {
  const test::TemporaryDirectory directory;
  { const LockFile lock(directory / "s.db"); }
  EXPECT_EQ(refusal_of_a_child(directory / "s.db"), "");
  EXPECT_NO_THROW(LockFile(directory / "s.db"));  // the child is gone without unlocking
}

TEST(LockFile, SaysWhyItCannotBeMade) {
  try {
    const LockFile lock("/proc/kinship/s.db");
    FAIL() << "a lock file in /proc";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("/proc/kinship/s.db.lock"), std::string::npos);
  }
}

}  // namespace
}  // namespace kinship::store::lock_file_test
