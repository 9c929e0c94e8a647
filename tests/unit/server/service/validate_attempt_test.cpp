#include "server/service/validate_attempt.hpp"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/server/fleet.hpp"

namespace kinship::service::validate_attempt_test {
namespace {

class CheckAttempt : public testing::Test {
 protected:
  /// The message, or empty.
  std::string check() const {
    const std::optional<Error> error = validate(attempt_, robot_);
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
}  // namespace kinship::service::validate_attempt_test
