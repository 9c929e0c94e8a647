#include "proto/files/output_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <future>
#include <iterator>
#include <sstream>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::files::output_file_test {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
 protected:
  static std::string content(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static void put(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

  test::TemporaryDirectory folder_;
  const fs::path file_ = folder_ / "results";
  const fs::path part_ = folder_ / "results.part";
  std::ostringstream otherwise_;
};

TEST_F(OutputFileTest, WithoutAFileTheStreamIsWritten) {
  OutputFile output({}, otherwise_);
  output.stream() << "line\n";
  output.keep();
  EXPECT_EQ(otherwise_.str(), "line\n");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(OutputFileTest, AFileHasItsNameOnceItIsWhole) {
  put(file_, "old\n");
  OutputFile output(file_, otherwise_);
  output.stream() << "new\n" << std::flush;
  EXPECT_EQ(content(file_), "old\n");
  EXPECT_EQ(content(part_), "new\n");
  output.keep();
  EXPECT_EQ(content(file_), "new\n");
  EXPECT_FALSE(fs::exists(part_));
}

TEST_F(OutputFileTest, WhatIsNotKeptStaysBesideTheOldFile) {
  put(file_, "old\n");
  { OutputFile(file_, otherwise_).stream() << "half"; }
  EXPECT_EQ(content(file_), "old\n");
  EXPECT_EQ(content(part_), "half");
}

TEST_F(OutputFileTest, NothingWrittenLeavesNothingBehind) {
  { const OutputFile output(file_, otherwise_); }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(OutputFileTest, ThereIsAPartOnceSomethingIsWrittenAndUntilItIsKept) {
  OutputFile output(file_, otherwise_);
  EXPECT_FALSE(output.has_part());
  output.stream() << "half";
  EXPECT_TRUE(output.has_part()) << "not flushed by its user";
  output.keep();
  EXPECT_FALSE(output.has_part());

  OutputFile no_file({}, otherwise_);
  no_file.stream() << "half";
  EXPECT_FALSE(no_file.has_part());
}

TEST_F(OutputFileTest, AnEmptyResultIsAResult) {
  put(file_, "old\n");
  OutputFile(file_, otherwise_).keep();
  EXPECT_EQ(content(file_), "");
}

TEST_F(OutputFileTest, PermissionsAreThoseOfTheOldFile) {
  put(file_, "old\n");
  fs::permissions(file_, fs::perms::owner_read | fs::perms::owner_write);
  OutputFile(file_, otherwise_).keep();
  EXPECT_EQ(fs::status(file_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFileTest, ASymbolicLinkIsWrittenThrough) {
  const fs::path target = folder_ / "target";
  put(target, "old\n");
  fs::create_symlink(target, file_);
  OutputFile output(file_, otherwise_);
  output.stream() << "new\n";
  output.keep();
  EXPECT_TRUE(fs::is_symlink(file_));
  EXPECT_EQ(content(target), "new\n");
}

TEST_F(OutputFileTest, AFifoIsWrittenThrough) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  auto read = std::async(std::launch::async, [&] { return content(file_); });
  {
    OutputFile output(file_, otherwise_);
    output.stream() << "new\n";
    output.keep();
  }
  EXPECT_EQ(read.get(), "new\n");
  EXPECT_TRUE(fs::is_fifo(file_));
}

TEST_F(OutputFileTest, ADeviceStaysADevice) {
  OutputFile output("/dev/null", otherwise_);
  output.stream() << "new\n";
  output.keep();
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, AFullDeviceIsAnErrorThatNamesIt) {
  OutputFile output("/dev/full", otherwise_);
  output.stream() << "new\n";
  try {
    output.keep();
    FAIL() << "kept on a full device";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("'/dev/full'"), std::string::npos) << failure.what();
  }
}

TEST_F(OutputFileTest, AFileThatCannotBeWrittenIsRefusedBeforeAnythingIsWritten) {
  EXPECT_THROW(OutputFile(folder_ / "nowhere" / "results", otherwise_), Failure);
  EXPECT_THROW(OutputFile(folder_.path(), otherwise_), Failure);
}

TEST_F(OutputFileTest, AWriteProtectedFileIsRefused) {
  if (geteuid() == 0)
    GTEST_SKIP() << "root may write everything";
  put(file_, "old\n");
  fs::permissions(file_, fs::perms::owner_read);
  EXPECT_THROW(OutputFile(file_, otherwise_), Failure);
  EXPECT_EQ(content(file_), "old\n");
}

TEST_F(OutputFileTest, KnowsWhenItWouldOverwriteItsInput) {
  put(file_, "problems\n");
  put(part_, "problems\n");
  fs::create_symlink(file_, folder_ / "link");
  EXPECT_TRUE(overwrites(file_, file_));
  EXPECT_TRUE(overwrites(folder_ / "link", file_));
  EXPECT_TRUE(overwrites(file_, part_));
  EXPECT_FALSE(overwrites(folder_ / "other", file_));
}

}  // namespace
}  // namespace kinship::files::output_file_test
