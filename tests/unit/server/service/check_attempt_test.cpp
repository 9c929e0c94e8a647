#include "server/service/check_attempt.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "proto/types/number_text.hpp"
#include "tests/unit/server/fleet.hpp"

namespace kinship::service::check_attempt_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class CheckAttempt : public testing::Test {
 protected:
  /// The message, or empty.
  std::string check() const {
    const std::optional<Error> error = check_attempt(attempt_, robot_);
    if (!error)
      return "";
    EXPECT_EQ(error->code, ErrorCode::InvalidInput);
    return error->message;
  }
  void set_joint(Eigen::Index joint, Eigen::Index waypoint, double value) {
    Eigen::MatrixXd waypoints = attempt_.path->waypoints();
    waypoints(joint, waypoint) = value;
    attempt_.path = Path(waypoints);
  }

  runtime::Robot robot_ = fleet::robot_of(fleet::teacher());
  Attempt attempt_ = fleet::solved(robot_, "shelf", 1);
};

TEST_F(CheckAttempt, AcceptsWhatAPlannerReports) {
  EXPECT_EQ(check(), "");
  attempt_ = fleet::unsolved(robot_.digest, "shelf");
  EXPECT_EQ(check(), "");
}

TEST_F(CheckAttempt, NamesRobotJointValueLimitAndWaypoint) {
  set_joint(2, 1, 3.31);
  EXPECT_EQ(check(), "robot 'teacher': joint 3 'j3' at 3.31 rad exceeds 2.8 rad, waypoint 2");
  set_joint(2, 1, -2.9);
  EXPECT_EQ(check(), "robot 'teacher': joint 3 'j3' at -2.9 rad is below -2.8 rad, waypoint 2");
}

TEST_F(CheckAttempt, RoundingAtALimitIsForgivenMoreIsNot) {
  set_joint(0, 0, fleet::kLimit_rad + 0.9e-6);
  EXPECT_EQ(check(), "");
  set_joint(0, 0, fleet::kLimit_rad + 1.1e-6);
  EXPECT_NE(check(), "");
}

TEST_F(CheckAttempt, SaysHowManyJointsThereShouldBe) {
  attempt_.path = fleet::path(4, 1);
  EXPECT_EQ(check(), "robot 'teacher': a path of 4 joints, but it has 3");
}

TEST_F(CheckAttempt, SolvedMeansThatThereIsAPath) {
  attempt_.path.reset();
  EXPECT_EQ(check(), "outcome: solved, but there is no path");
  attempt_ = fleet::solved(robot_, "shelf", 1);
  attempt_.record.outcome = Outcome::Failed;
  EXPECT_EQ(check(), "outcome: not solved, but there is a path");
}

TEST_F(CheckAttempt, NamesAreChecked) {
  attempt_.task = "shelf pick";
  EXPECT_EQ(check(), "task: byte 6 is not one of A-Z a-z 0-9 _ . : -");
  attempt_.task = "shelf";
  attempt_.machine = "cell\n1";
  EXPECT_EQ(check(), "machine: byte 5 is a control character");
}

TEST_F(CheckAttempt, ShareIsAFraction) {
  for (const double share : {-0.1, 1.5, kNan}) {
    attempt_.record.share = share;
    EXPECT_EQ(check(), "share: " + number_text(share) + " is not within 0 to 1");
  }
}

TEST_F(CheckAttempt, TimesAreFiniteAndNotNegative) {
  attempt_.record.planning_time_s = kInfinity;
  EXPECT_EQ(check(), "planning time: inf s is not a time of at least 0 s");
  attempt_.record.planning_time_s = 0;
  attempt_.record.time_limit_s = -2;
  EXPECT_EQ(check(), "time limit: -2 s is not a time of at least 0 s");
}

TEST_F(CheckAttempt, PlacementIsFiniteAndNotTooFar) {
  attempt_.T_task_base = Eigen::Isometry3d::Identity();
  EXPECT_EQ(check(), "");
  attempt_.T_task_base->translation().x() = 1500;
  EXPECT_EQ(check(), "placement: 1500 m exceeds 1000 m");
  attempt_.T_task_base->translation().x() = kNan;
  EXPECT_EQ(check(), "placement: a number is not finite");
}

TEST_F(CheckAttempt, LengthsHaveLimits) {
  attempt_.record.planner_options = std::string(1025, 'x');
  EXPECT_EQ(check(), "planner options: 1025 bytes exceed 1024");
  attempt_.record.planner_options.clear();
  attempt_.path = Path(Eigen::MatrixXd::Zero(3, 16385));
  EXPECT_EQ(check(), "robot 'teacher': 16385 waypoints exceed 16384");
}

TEST_F(CheckAttempt, AJointWithoutLimitsCountsItsTurnsUpToALimit) {
  RobotDescription wheel = fleet::teacher();
  for (std::size_t at; (at = wheel.urdf.find("'revolute'")) != std::string::npos;)
    wheel.urdf.replace(at, 10, "'continuous'");
  robot_ = fleet::robot_of(wheel);
  set_joint(2, 1, -9999.5);
  EXPECT_EQ(check(), "");
  set_joint(2, 1, 12345);
  EXPECT_EQ(check(), "robot 'teacher': joint 3 'j3' at 12345 rad exceeds 10000 rad, waypoint 2");
  set_joint(2, 1, -1e308);
  EXPECT_NE(check().find("is below -10000 rad"), std::string::npos) << check();
}

}  // namespace
}  // namespace kinship::service::check_attempt_test
