#include "client/plan/planner_choice.hpp"

#include <gtest/gtest.h>

namespace kinship::plan {
namespace {

TEST(PlannerChoice, ReadsWhatItCanBeTold) {
  EXPECT_EQ(parse_planner("birrt").value(), Planner::Birrt);
  EXPECT_EQ(parse_planner("cbirrt2").value(), Planner::Cbirrt2);
  for (const char* unknown : {"", "BiRRT", "rrt", "by problem"})
    EXPECT_FALSE(parse_planner(unknown)) << unknown;
}

TEST(PlannerChoice, TheProblemDecidesUnlessSaid) {
  EXPECT_EQ(planner_for(Planner::ByProblem, false).value(), Planner::Birrt);
  EXPECT_EQ(planner_for(Planner::ByProblem, true).value(), Planner::Cbirrt2);
  EXPECT_EQ(planner_for(Planner::Cbirrt2, false).value(), Planner::Birrt);
}

TEST(PlannerChoice, WhatAPlannerCannotDoIsRefusedWithWhatCan) {
  const Result<Planner> planner = planner_for(Planner::Birrt, true);
  ASSERT_FALSE(planner);
  EXPECT_NE(planner.error().message.find("--planner cbirrt2"), std::string::npos);
}

}  // namespace
}  // namespace kinship::plan
