#include "client/page/bones.hpp"

#include <gtest/gtest.h>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::page::bones_test {
namespace {

models::LoadedRobot load(const std::string& name) {
  models::RobotArguments arguments;
  arguments.source = std::filesystem::path(test::source_dir() + "/robots/models") / name;
  return models::load_robot(arguments).value_or_throw();
}

TEST(Bones, AreAsManyAsShapesAndMoveWithTheRobot) {
  const models::LoadedRobot robot = load("ur10e");
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(robot.chain.dof());
  const Eigen::Vector3d shift(1, 2, 3);
  const auto here = bones_of(robot, Eigen::Isometry3d::Identity(), q);
  const auto there = bones_of(robot, Eigen::Isometry3d(Eigen::Translation3d(shift)), q);
  ASSERT_EQ(here.size(), robot.shapes.shapes.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_TRUE((there[i].from - here[i].from).isApprox(shift));
    EXPECT_TRUE((there[i].to - here[i].to).isApprox(shift));
    EXPECT_GT(here[i].radius_m, 0);
    EXPECT_LT(here[i].from.norm(), 2.5);
  }
}

TEST(Bones, WhatIsHeldStaysInTheHand) {
  const models::LoadedRobot robot = load("ur10e");
  AttachedObject box;
  box.name = "box";
  box.link = robot.chain.tip_link();
  box.shape = BoxShape{{0.1, 0.2, 0.3}};
  box.T_link_object = Eigen::Translation3d(0, 0, 0.2);
  const Eigen::Isometry3d T_task_base(Eigen::Translation3d(1, 0, 0));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(robot.chain.dof(), 0.3);

  const auto held = held_objects(robot, {box}, T_task_base, q);

  ASSERT_EQ(held.size(), 1U);
  EXPECT_TRUE(held[0].T_task_object.isApprox(T_task_base * kinematics::T_base_tip(robot.chain, q) *
                                             box.T_link_object));
  box.link = "no such link";
  EXPECT_THROW(held_objects(robot, {box}, T_task_base, q), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::page::bones_test
