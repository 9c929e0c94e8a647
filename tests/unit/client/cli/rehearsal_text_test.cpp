#include "client/cli/rehearsal_text.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace kinship::cli::rehearsal_text_test {
namespace {

std::string printed(const std::optional<Rehearsal>& rehearsal) {
  std::ostringstream out;
  print_rehearsal(rehearsal, out);
  return out.str();
}

Rehearsal rehearsed() {
  return {.guide = Guide::Ways,
          .is_complete = true,
          .queries = 100,
          .processor_time_s = 74.31,
          .costs = {{Guide::None, 400, 396, 1552.4, 803},
                    {Guide::Ways, 400, 400, 361, 154},
                    {Guide::RetreatMixture, 100, 99, 3104.8, 1200}}};
}

TEST(PrintRehearsal, ComparesGuidesAndMarksTheOneToUse) {
  EXPECT_EQ(printed(rehearsed()),
            "rehearsed on 100 recorded queries, 74.3 s of processor time\n"
            "GUIDE            PLANS  SOLVED  MEAN CHECKS  MEDIAN  UNIFORM /\n"
            "                                             CHECKS     GUIDED\n"
            "none               400     396         1552     803       1.00\n"
            "ways               400     400          361     154       4.30  chosen\n"
            "retreat+mixture    100      99         3105    1200       0.50\n");
}

TEST(PrintRehearsal, SaysHowManyQueriesWereLeftOutAndWhy) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.queries = 1;
  rehearsal.left_out = 3;
  EXPECT_TRUE(printed(rehearsal).starts_with(
      "rehearsed on 1 recorded query (3 left out: the robot cannot take their start or goal where "
      "it stands), 74.3 s"))
      << printed(rehearsal);
}

TEST(PrintRehearsal, SaysThatThereIsMoreToCome) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.is_complete = false;
  EXPECT_TRUE(printed(rehearsal).starts_with("being rehearsed on 100 recorded queries, "));
}

TEST(PrintRehearsal, SaysWhatBeginsOne) {
  EXPECT_EQ(printed({}), "not rehearsed yet: a fetch that asks for stored ways begins it\n");
}

TEST(PrintRehearsal, SaysWhyThereIsNothingToSay) {
  const std::string why = "no recorded query can be planned by this robot where it stands";
  EXPECT_EQ(printed(Rehearsal{.is_complete = true, .left_out = 4, .message = why}), why + "\n");
  EXPECT_EQ(printed(Rehearsal{}), "not rehearsed: there is no recorded query\n");
}

TEST(PrintRehearsal, ComparesWithNothingIfUniformSamplingWasNotTried) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.costs.erase(rehearsal.costs.begin());
  rehearsal.costs[1].mean_checks = 0;
  EXPECT_NE(printed(rehearsal).find("154  -          chosen\n"), std::string::npos)
      << printed(rehearsal);
}

}  // namespace
}  // namespace kinship::cli::rehearsal_text_test
