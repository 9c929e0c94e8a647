#include "client/guided/planner_choice.hpp"

#include <gtest/gtest.h>

namespace kinship::guided::planner_choice_test {
namespace {

PlannerKind kind_for(PlannerKind wanted, bool is_constrained) {
  return planner_for({wanted}, is_constrained).value().kind;
}

TEST(PlannerChoice, ReadsWhatItCanBeTold) {
  EXPECT_EQ(parse_planner("birrt").value().kind, PlannerKind::Birrt);
  EXPECT_EQ(parse_planner("cbirrt2").value().kind, PlannerKind::Cbirrt2);
  EXPECT_EQ(parse_planner("roadmap").value().kind, PlannerKind::Roadmap);
  const PlannerChoice ompl = parse_planner("ompl:LazyPRM").value();
  EXPECT_EQ(ompl.kind, PlannerKind::Ompl);
  EXPECT_EQ(ompl.ompl_planner, "LazyPRM");
  EXPECT_EQ(name_of(ompl), "OMPL LazyPRM");
  for (const char* unknown : {"", "BiRRT", "rrt", "by problem", "ompl:", "ompl"})
    EXPECT_FALSE(parse_planner(unknown)) << unknown;
}

TEST(PlannerChoice, AnUnknownPlannerOfOmplIsAnsweredWithThoseThereAre) {
  const Result<PlannerChoice> planner = parse_planner("ompl:Nobody");
  ASSERT_FALSE(planner);
  EXPECT_NE(planner.error().message.find("'Nobody'"), std::string::npos);
  EXPECT_NE(planner.error().message.find("RRTConnect"), std::string::npos);
}

TEST(PlannerChoice, TheProblemDecidesUnlessSaid) {
  EXPECT_EQ(kind_for(PlannerKind::ByProblem, false), PlannerKind::Birrt);
  EXPECT_EQ(kind_for(PlannerKind::ByProblem, true), PlannerKind::Cbirrt2);
  EXPECT_EQ(kind_for(PlannerKind::Cbirrt2, false), PlannerKind::Birrt);
  EXPECT_EQ(kind_for(PlannerKind::Roadmap, false), PlannerKind::Roadmap);
  EXPECT_EQ(kind_for(PlannerKind::Roadmap, true), PlannerKind::Roadmap);
  EXPECT_EQ(planner_for(parse_planner("ompl:RRT").value(), true).value().ompl_planner, "RRT");
}

TEST(PlannerChoice, WhatAPlannerCannotDoIsRefusedWithWhatCan) {
  const Result<PlannerChoice> planner = planner_for({PlannerKind::Birrt}, true);
  ASSERT_FALSE(planner);
  EXPECT_NE(planner.error().message.find("--planner cbirrt2"), std::string::npos);
}

}  // namespace
}  // namespace kinship::guided::planner_choice_test
