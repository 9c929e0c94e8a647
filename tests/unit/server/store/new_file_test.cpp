#include "server/store/sqlite/files/new_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::new_file_test {
namespace {

namespace fs = std::filesystem;

class NewFiles : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(directory_ / name.c_str(), std::ios::binary) << text;
  }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_.path()), {}));
  }

  test::TemporaryDirectory directory_;
};

TEST_F(NewFiles, WhatSomebodyElseHasStays) {
  write("copy.db.part", "somebody's");
  write("copy.db.kinship-0123abcd.part", "no database, whatever its name says");
  write("copy.db.kinship-0123abcd.part.txt.part", "");
  write("other.db.kinship-0123abcd.part", "");
  {
    const NewFile file(directory_ / "copy.db");
    EXPECT_TRUE(fs::exists(file.part()));
    EXPECT_EQ(entries(), 5U);
  }
  EXPECT_EQ(entries(), 4U);
}

TEST_F(NewFiles, WhatAKilledProcessLeftGoes) {
  write("copy.db.kinship-0123abcd.part", "");
  write("copy.db.kinship-11111111.part", std::string("SQLite format 3\0 and pages", 26));
  write("copy.db.kinship-11111111.part-journal", "of it");
  write("copy.db.kinship-22222222.part-journal", "of one that is gone");
  NewFile file(directory_ / "copy.db");
  EXPECT_EQ(entries(), 1U);
  file.publish();
  EXPECT_TRUE(fs::exists(directory_ / "copy.db"));
  EXPECT_EQ(entries(), 1U);
}

TEST_F(NewFiles, OnlyOneWritesAFileAtATime) {
  const NewFile first(directory_ / "copy.db");
  try {
    const NewFile second(directory_ / "copy.db");
    FAIL() << "two write it";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Conflict);
    EXPECT_NE(std::string(failure.what()).find("somebody else is writing it"), std::string::npos);
  }
  EXPECT_TRUE(fs::exists(first.part()));
}

}  // namespace
}  // namespace kinship::store::new_file_test
