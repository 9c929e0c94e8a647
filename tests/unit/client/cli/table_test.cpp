#include "client/cli/table.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>

namespace kinship::cli::table_test {
namespace {

TEST(Table, AlignsTextLeftAndNumbersRight) {
  Table table({"TASK", "PATHS"});
  table.add_row({"box_to_shelf", "7"});
  table.add_row({"pick", "12345"});
  std::ostringstream out;
  table.print(out);
  EXPECT_EQ(out.str(),
            "TASK          PATHS\n"
            "box_to_shelf      7\n"
            "pick          12345\n");
}

TEST(Table, SaysSoIfThereAreNoRows) {
  std::ostringstream out;
  Table({"TASK"}).print(out);
  EXPECT_EQ(out.str(), "(none)\n");
}

TEST(Table, RefusesARowOfAnotherWidth) {
  Table table({"TASK", "PATHS"});
  EXPECT_THROW(table.add_row({"pick"}), std::invalid_argument);
}

TEST(TimeText, IsUtcToTheSecond) {
  EXPECT_EQ(time_text(0), "1970-01-01T00:00:00Z");
  EXPECT_EQ(time_text(1'795'226'587'999), "2026-11-21T02:03:07Z");
}

}  // namespace
}  // namespace kinship::cli::table_test
