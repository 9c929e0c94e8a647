#include "client/planner/progress.hpp"

#include <gtest/gtest.h>

namespace kinship::planner::result_text_test {
namespace {

ProblemResult solved_result() {
  ProblemResult result;
  result.name = "shelf-1";
  result.solved = true;
  result.collision_checks = 3804;
  result.planning_time_s = 0.4123;
  result.time_limit_s = 10;
  result.waypoints = Eigen::MatrixXd::Zero(7, 12);
  result.planner = "BiRRT";
  return result;
}

TEST(ResultText, TellsWhatASolutionCostAndWhatGuidedIt) {
  ProblemResult result = solved_result();
  result.distribution_id = Digest{};
  result.distribution_revision = 4;
  result.sampling_mode = SamplingMode::Guided;
  result.share = 0.9;
  EXPECT_EQ(result_text(result),
            "shelf-1: solved, 12 waypoints; BiRRT, 3804 checks in 412 ms of 10 s; guided by " +
                Digest{}.short_hex() + " revision 4, share 0.90");
}

TEST(ResultText, TellsWhyItIsNotSolvedAndNotGuided) {
  ProblemResult result = solved_result();
  result.solved = false;
  result.waypoints.reset();
  result.reason = "time used up";
  result.guidance_reason = "no server answered";
  EXPECT_EQ(result_text(result),
            "shelf-1: not solved, time used up; BiRRT, 3804 checks in 412 ms of 10 s; "
            "uniform: no server answered");
}

TEST(ResultText, NamesABrokenLineOnce) {
  ProblemResult result;
  result.name = "line 3";
  result.reason = "line 3: not JSON";
  result.not_planned = NotPlanned::Unreadable;
  EXPECT_EQ(result_text(result), "line 3: not JSON");
  result.name = "misfit";
  result.reason = "start has 6 joints";
  EXPECT_EQ(result_text(result), "misfit: start has 6 joints");
}

}  // namespace
}  // namespace kinship::planner::result_text_test
