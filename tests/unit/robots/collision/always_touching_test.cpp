#include "robots/collision/pair_sampling.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::always_touching_test {
namespace {

using Names = std::set<std::pair<std::string, std::string>>;

/// Every pair in every sample, as it is written.
Names looked_at_everywhere(const RobotSolids& robot, const Surroundings& surroundings,
                           const TouchSamples& samples) {
  CollisionWorld world(robot, surroundings);
  const kinematics::Chain& chain = robot.parts().chain;
  std::mt19937_64 generator(1);
  std::map<std::pair<std::string, std::string>, int> touches;
  for (int sample = 0; sample < samples.count; ++sample) {
    Eigen::VectorXd q(chain.dof());
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    for (const auto& names : world.find_contacts(q))
      ++touches[names];
  }
  Names always;
  for (const auto& [names, count] : touches)
    if (count >= samples.least)
      always.insert(names);
  return always;
}

/// Boxes of all sizes about the robot, and something in its hand.
Surroundings random_surroundings(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> size(0.05, 1.5), place(-0.8, 0.8);
  Surroundings surroundings;
  for (int i = 0; i < 6; ++i) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d::NullaryExpr([&] { return place(generator); });
    const Eigen::Vector3d sizes = Eigen::Vector3d::NullaryExpr([&] { return size(generator); });
    surroundings.scene.objects.push_back({"box" + std::to_string(i), BoxShape{sizes}, T});
  }
  surroundings.attached.push_back(
      {"can", chain.tip_link(), SphereShape{0.15}, Eigen::Isometry3d::Identity(), {}});
  return surroundings;
}

TEST(AlwaysTouching, IsWhatTouchesInEnoughOfAllSamples) {
  const RobotDescription description = test::model_description("ur10e");
  const kinematics::Chain chain = test::model_chain("ur10e");
  const RobotSolids robot(
      chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw());
  std::mt19937_64 generator(3);
  std::size_t found = 0;
  for (int scene = 0; scene < 6; ++scene) {
    Surroundings surroundings = random_surroundings(chain, generator);
    surroundings.checks_links = scene % 2 == 0;
    for (const int least : {1, 7, 13, 18, 20}) {
      const TouchSamples samples{.count = 20, .least = least};
      const Names always = always_touching(robot, surroundings, samples);
      EXPECT_EQ(always, looked_at_everywhere(robot, surroundings, samples)) << least;
      found += always.size();
    }
  }
  EXPECT_GT(found, 100U);
}

TEST(AlwaysTouching, WhatIsNotCheckedForItIsNamed) {
  using namespace test_support;
  geometry::RobotShapes shapes = toy_shapes(3);
  EXPECT_EQ(describe_always_touching(RobotSolids(toy_chain(3), shapes)), "");
  shapes.shapes.push_back({3, SphereShape{500}, shift(0)});  // mm for m
  const std::string text = describe_always_touching(RobotSolids(toy_chain(3), shapes));
  EXPECT_TRUE(
      text.starts_with("'link1' and 'link3' touch wherever the robot goes, so they are not "
                       "checked against each other"))
      << text;
  shapes.never_colliding = {{0, 1}};
  EXPECT_EQ(describe_always_touching(RobotSolids(toy_chain(3), shapes)), "") << "all are checked";
}

TEST(AlwaysTouching, LinksAreLeftAloneWhereTheyAreNotAskedAbout) {
  const RobotDescription description = test::model_description("ur10e");
  const kinematics::Chain chain = test::model_chain("ur10e");
  const RobotSolids robot(
      chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw());
  EXPECT_FALSE(always_touching(robot, {}, {.count = 200, .least = 1}).empty());
  Surroundings surroundings;
  surroundings.checks_links = false;
  EXPECT_TRUE(always_touching(robot, surroundings, {.count = 200, .least = 1}).empty());
}

}  // namespace
}  // namespace kinship::collision::always_touching_test
