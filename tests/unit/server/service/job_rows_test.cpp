#include "server/service/job_rows.hpp"

#include <gtest/gtest.h>

#include "proto/types/failure.hpp"

namespace kinship::service::job_rows_test {
namespace {

using Rows = std::vector<std::string>;

JobRows some_rows() {
  JobRows rows(1000);
  for (const char* row : {"one", "", "three", "four"})
    rows.add(row);
  return rows;
}

TEST(JobRows, ComeOutAsTheyWentIn) {
  EXPECT_EQ(some_rows().page(0, 10, 1000), (Rows{"one", "", "three", "four"}));
}

TEST(JobRows, APageHasALimitOfRowsAndOfBytes) {
  EXPECT_EQ(some_rows().page(1, 2, 1000), (Rows{"", "three"}));
  EXPECT_EQ(some_rows().page(0, 10, 8), (Rows{"one", "", "three"}));
  EXPECT_EQ(some_rows().page(0, 10, 7), (Rows{"one", ""}));
}

TEST(JobRows, ARowLongerThanAPageIsAPageOfItsOwn) {
  EXPECT_EQ(some_rows().page(2, 10, 1), Rows{"three"});
}

TEST(JobRows, NothingFollowsTheLastRow) { EXPECT_TRUE(some_rows().page(4, 10, 1000).empty()); }

TEST(JobRows, TheErrorNamesRowSizeAndLimit) {
  JobRows rows(24);
  rows.add("12345678");  // and 8 bytes for where it ends
  try {
    rows.add("1");
    FAIL() << "no error";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::TooLarge);
    EXPECT_STREQ(failure.what(),
                 "row 2 needs 25 bytes together with those before it, a job may keep 24");
  }
  EXPECT_EQ(rows.size(), 1U);
}

}  // namespace
}  // namespace kinship::service::job_rows_test
