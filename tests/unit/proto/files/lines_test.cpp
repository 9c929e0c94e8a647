#include "proto/files/lines.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::files::lines_test {
namespace {

std::vector<std::string> read(const std::string& text, std::size_t max_bytes = kMaxLineBytes) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for_each_line(
      stream, "lines",
      [&](const Line& line) {
        lines.push_back(std::to_string(line.number) + ":" +
                        (line.text ? *line.text : line.text.error().message));
        return true;
      },
      max_bytes);
  return lines;
}

using Lines = std::vector<std::string>;

TEST(ForEachLine, CountsBlankLinesButLeavesThemOut) {
  EXPECT_EQ(read("a\n\n \t\r\nb\n"), (Lines{"1:a", "4:b"}));
}

TEST(ForEachLine, TheLastLineNeedsNoLineFeed) { EXPECT_EQ(read("a\nb"), (Lines{"1:a", "2:b"})); }

TEST(ForEachLine, AnEmptyFileHasNoLines) { EXPECT_EQ(read(""), Lines{}); }

TEST(ForEachLine, ALineBeyondTheLimitIsAnErrorAndTheNextOneIsReadWhole) {
  EXPECT_EQ(read("1234\n12345\n      \n123\n", 4),
            (Lines{"1:1234", "2:more than 4 bytes", "3:more than 4 bytes", "4:123"}));
}

TEST(ForEachLine, EndsWhenItsUserHasSeenEnough) {
  std::istringstream stream("a\nb\nc\n");
  std::size_t last = 0;
  for_each_line(stream, "lines", [&](const Line& line) {
    last = line.number;
    return last < 2;
  });
  EXPECT_EQ(last, 2U);
}

TEST(ForEachLine, AReadErrorNamesFileAndLine) {
  const test::TemporaryDirectory folder;
  std::ifstream stream(folder.path());  // a directory opens but cannot be read
  ASSERT_TRUE(stream);
  try {
    for_each_line(stream, "problems", [](const Line&) { return true; });
    FAIL() << "a directory was read";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Storage);
    EXPECT_NE(std::string(failure.what()).find("'problems' at line 1"), std::string::npos)
        << failure.what();
  }
}

TEST(OpenInput, NamesAFileThatIsNotThere) {
  try {
    open_input("/nowhere/file");
    FAIL() << "opened";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::NotFound);
    EXPECT_NE(std::string(failure.what()).find("/nowhere/file"), std::string::npos);
  }
}

TEST(OpenInput, AFolderIsNoFile) {
  const test::TemporaryDirectory folder;
  try {
    open_input(folder.path());
    FAIL() << "opened";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::InvalidInput);
    EXPECT_EQ(std::string(failure.what()),
              "cannot read '" + folder.path().string() + "': it is a folder");
  }
}

}  // namespace
}  // namespace kinship::files::lines_test
