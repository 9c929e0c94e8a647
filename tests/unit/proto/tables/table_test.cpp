#include "proto/tables/table.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <stdexcept>
#include <string>

#include "proto/tables/table_layout.hpp"

namespace kinship::tables::table_test {
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

TEST(Table, GoesOnInASecondLineWhereItIsTooWideAndCutsWhatMayBeCut) {
  Table table({"ID", {"ROBOT", Fit::Cut}, "MADE OF", {"MACHINE", Fit::Wide}});
  table.add_row({"3f9a0c11", "a_robot_with_a_name", "default, only panda iiwa14", "cell 7"});
  std::ostringstream narrow;
  set_table_layout(narrow, {36, false});
  table.print(narrow);
  EXPECT_EQ(narrow.str(),
            "ID        ROBOT         MADE OF\n"
            "3f9a0c11  a_robot_wi..  default,\n"
            "                        only panda\n"
            "                        iiwa14\n");
  std::ostringstream uncut;
  set_table_layout(uncut, {.width = 36, .cuts = false});
  table.print(uncut);
  EXPECT_EQ(uncut.str(),
            "ID        ROBOT                MADE OF\n"
            "3f9a0c11  a_robot_with_a_name  default,\n"
            "                               only\n"
            "                               panda\n"
            "                               iiwa14\n");
  std::ostringstream wide;
  set_table_layout(wide, {36, true});
  table.print(wide);
  EXPECT_EQ(wide.str(),
            "ID        ROBOT                MADE OF                     MACHINE\n"
            "3f9a0c11  a_robot_with_a_name  default, only panda iiwa14  cell 7\n");
}

TEST(Table, NeverCutsAWordThatMustStayWhole) {
  Table table({"PATH", {"TASK", Fit::Cut}});
  table.add_row({"7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55", "schrank_gr\xC3\xBCn_einr\xC3\xA4umen"});
  std::ostringstream out;
  set_table_layout(out, {20, false});
  table.print(out);
  EXPECT_NE(out.str().find("7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55  schr..\n"), std::string::npos)
      << out.str();
}

}  // namespace
}  // namespace kinship::tables::table_test
