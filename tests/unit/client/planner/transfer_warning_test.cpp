#include "client/planner/transfer_warning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::planner::transfer_warning_test {
namespace {

ProblemLine line_of(Problem problem) { return {1, Result<Problem>(std::move(problem))}; }

Problem of_joints() {
  Problem problem;
  problem.name = "by joints";
  problem.start = Eigen::VectorXd::Zero(2);
  problem.goal_configurations = Eigen::MatrixXd::Ones(2, 1);
  return problem;
}

TEST(TransferWarning, NamesTheFirstProblemWithAPoseAndWhatToPass) {
  Problem posed = of_joints();
  posed.name = "by pose";
  posed.T_task_goal = Eigen::Isometry3d::Identity();
  const std::string warning = transfer_warning({{1, Error{ErrorCode::InvalidInput, "broken"}},
                                                line_of(of_joints()),
                                                line_of(posed),
                                                line_of(posed)},
                                               "tool0");
  EXPECT_EQ(warning.find("warning: the goal of 'by pose' is a pose"), 0U) << warning;
  EXPECT_NE(warning.find("those of the tip link 'tool0'"), std::string::npos) << warning;
  EXPECT_NE(warning.find("--transfer \"x y z qx qy qz qw\""), std::string::npos) << warning;
  EXPECT_EQ(std::count(warning.begin(), warning.end(), '\n'), 1);
  posed.T_task_start = Eigen::Isometry3d::Identity();
  EXPECT_EQ(transfer_warning({line_of(posed)}, "tool0").find("warning: the start of 'by pose'"),
            0U);
}

TEST(TransferWarning, IsSilentWhereOnlyJointsAreGiven) {
  EXPECT_EQ(transfer_warning({line_of(of_joints())}, "tool0"), "");
  EXPECT_EQ(transfer_warning({}, "tool0"), "");
}

TEST(TransferWarning, AFolderOrAnOptionSaysTheTransferFrame) {
  const std::string folder = kinship::test::source_dir() + "/robots/models/panda";
  EXPECT_TRUE(models::says_transfer({.source = folder}));
  EXPECT_FALSE(models::says_transfer({.source = folder + "/robot.urdf"}));
  EXPECT_TRUE(
      models::says_transfer({.source = folder + "/robot.urdf", .transfer = "0 0 0 0 0 0 1"}));
}

}  // namespace
}  // namespace kinship::planner::transfer_warning_test
