#include "proto/ros2/questions.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace kinship::ros2 {
namespace {

/// A solved query of two joints and three points, whose memory the object has.
class ThreePoints {
 public:
  ThreePoints() {
    path.task = task_.data();
    path.machine = path.planner = path.planner_options = empty_.data();
    path.planning_time = 0.5;
    path.collision_checks = 100;
    path.sampling_mode = 2;
    path.uuid.uuid[0] = 1;
    path.robot[0] = 7;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_[i].positions._buffer = positions_[i].data();
      points_[i].positions._length = 2;
    }
    path.trajectory.points._buffer = points_.data();
    path.trajectory.points._length = 3;
    path.trajectory.joint_names._buffer = names_.data();
    path.trajectory.joint_names._length = 2;
  }

  void add_object(std::uint8_t type, std::vector<double> dimensions) {
    dimensions_ = std::move(dimensions);
    object_.id = id_.data();
    object_.solid.type = type;
    object_.solid.dimensions._buffer = dimensions_.data();
    object_.solid.dimensions._length = static_cast<std::uint32_t>(dimensions_.size());
    object_.pose.orientation.w = 1;
    path.has_scene = true;
    path.objects._buffer = &object_;
    path.objects._length = 1;
  }

  void repeat_last_point(std::size_t count) {
    points_.resize(count, points_.back());
    path.trajectory.points._buffer = points_.data();
    path.trajectory.points._length = static_cast<std::uint32_t>(count);
  }

  wire::PlannedPath path{};

 private:
  std::string task_ = "shelf", empty_, id_ = "box", first_ = "elbow", second_ = "shoulder";
  std::vector<char*> names_ = {first_.data(), second_.data()};
  std::array<std::vector<double>, 3> positions_ = {{{10, 1}, {20, 2}, {30, 3}}};
  std::vector<trajectory_msgs_msg_JointTrajectoryPoint> points_{3};
  std::vector<double> dimensions_;
  kinship_msgs_msg_dds__SceneObject_ object_{};
};

std::string refusal_of(const wire::PlannedPath& path) {
  const PathReport report = read(path).value();
  return report.request.refused.empty() ? "" : report.request.refused[0].message;
}

TEST(RosQuestions, AReportHasItsPathInTheOrderOfTheChain) {
  const ThreePoints sent;
  PathReport report = read(sent.path).value();
  ASSERT_EQ(report.request.attempts.size(), 1U);
  EXPECT_EQ(report.request.attempts[0].path->waypoints()(0, 2), 30);
  EXPECT_FALSE(order_joints(report, {"shoulder", "elbow"}));
  EXPECT_EQ(report.request.attempts[0].path->waypoints()(0, 2), 3);
  EXPECT_EQ(report.request.attempts[0].path->waypoints()(1, 0), 10);
}

TEST(RosQuestions, AJointThatIsMissingOrNamedTwiceIsAnError) {
  ThreePoints sent;
  PathReport report = read(sent.path).value();
  EXPECT_NE(order_joints(report, {"shoulder", "wrist"})->message.find("'wrist'"),
            std::string::npos);
  sent.path.trajectory.joint_names._buffer[1] = sent.path.trajectory.joint_names._buffer[0];
  report = read(sent.path).value();
  EXPECT_TRUE(order_joints(report, {"elbow"}));
}

TEST(RosQuestions, ASolidHasTheDimensionsOfItsKind) {
  ThreePoints sent;
  sent.add_object(3, {0.5, 0.1});  // CYLINDER: height, radius
  const PathReport report = read(sent.path).value();
  ASSERT_EQ(report.request.attempts.size(), 1U) << refusal_of(sent.path);
  const ShapeNumbers shape = to_numbers(report.request.attempts[0].scene->objects.at(0).shape);
  EXPECT_EQ(shape.kind, 1U);
  EXPECT_EQ(shape.sizes[0], 0.1);
  EXPECT_EQ(shape.sizes[1], 0.5);
  sent.add_object(4, {0.5, 0.1});  // CONE
  EXPECT_NE(refusal_of(sent.path).find("type 4"), std::string::npos) << refusal_of(sent.path);
  sent.add_object(1, {0.5, 0.1});
  EXPECT_NE(refusal_of(sent.path).find("2 dimensions"), std::string::npos);
}

TEST(RosQuestions, APathBeyondTheLimitsIsRefusedWithItsReason) {
  ThreePoints sent;
  sent.repeat_last_point(kMaxWaypoints + 1);
  EXPECT_NE(refusal_of(sent.path).find("points"), std::string::npos) << refusal_of(sent.path);
  ThreePoints uneven;
  uneven.path.trajectory.points._buffer[1].positions._length = 1;
  EXPECT_NE(refusal_of(uneven.path).find("1 positions of point 1"), std::string::npos);
}

TEST(RosQuestions, RulesOfKinshipHoldForRosMessages) {
  ThreePoints sent;
  std::string hostile = "a task/with a slash";
  sent.path.task = hostile.data();
  EXPECT_NE(refusal_of(sent.path).find("task"), std::string::npos) << refusal_of(sent.path);
  wire::DistributionQuery query{};
  query.task = hostile.data();
  EXPECT_FALSE(read(query));
  std::string task = "shelf", profile = "default";
  query.task = task.data();
  query.profile = profile.data();
  query.follow = {1, 1'000'000};
  EXPECT_EQ(read(query).value().follow, std::chrono::seconds(2)) << "not shorter than asked";
  query.deadline.sec = -1;
  EXPECT_FALSE(read(query));
}

}  // namespace
}  // namespace kinship::ros2
