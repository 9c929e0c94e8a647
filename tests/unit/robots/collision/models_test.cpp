#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::models_test {
namespace {

constexpr std::uint64_t kSeed = 2;

CollisionWorld bare_world(const std::string& name, const Surroundings& surroundings = {}) {
  const auto shapes = geometry::read_shapes(test::robot_model(name));
  return CollisionWorld(test::model_chain(name), shapes.value(), surroundings);
}

Eigen::VectorXd ready(const std::string& name) {
  if (name == "panda")
    return test_support::angles({0, -0.785, 0, -2.356, 0, 1.571, 0.785});
  if (name == "ur10e")
    return test_support::angles({0, -1.57, 1.57, -1.57, -1.57, 0});
  if (name == "sawyer")
    return test_support::angles({0, -1.18, 0, 2.18, 0, 0.57, 3.3161});
  if (name == "panda_lift")
    return test_support::angles({0.2, 0, -0.785, 0, -2.356, 0, 1.571, 0.785});
  if (name == "iiwa14_lift")
    return test_support::angles({0.2, 0, 0.5, 0, -1.5, 0, 1.1, 0});
  return test_support::angles({0, 0.5, 0, -1.5, 0, 1.1, 0});
}

std::string words(const std::optional<std::pair<std::string, std::string>>& contact) {
  return contact ? contact->first + " touches " + contact->second : "";
}

class Model : public testing::TestWithParam<std::string> {};

TEST_P(Model, IsFreeWhereItStandsReady) {
  EXPECT_EQ(words(bare_world(GetParam()).find_contact(ready(GetParam()))), "");
}

/// All but the Sawyer, which has the cylinders and spheres of its manufacturer.
class ModelOfCapsules : public Model {};

TEST_P(ModelOfCapsules, HasCapsules) {
  const auto shapes = geometry::read_shapes(test::robot_model(GetParam()));
  ASSERT_TRUE(shapes);
  EXPECT_TRUE(std::any_of(shapes->shapes.begin(), shapes->shapes.end(), [](const auto& shape) {
    return std::holds_alternative<CapsuleShape>(shape.shape);
  }));
}

TEST_P(Model, CollidesWithItselfInSomeButNotMostConfigurations) {
  CollisionWorld world = bare_world(GetParam());
  const kinematics::Chain chain = test::model_chain(GetParam());
  std::mt19937_64 generator(kSeed);
  // The stand-in is slim and its elbow bends by 130 degrees only.
  const bool slim = GetParam() == "sara_like";
  const int configurations = slim ? 3000 : 300;
  int colliding = 0;
  for (int i = 0; i < configurations; ++i)
    colliding += world.collides(test::random_configuration(chain, generator));
  EXPECT_GT(colliding, configurations / (slim ? 1000 : 100));
  EXPECT_LT(colliding, configurations / 2);
  RecordProperty("colliding", colliding);
}

TEST_P(Model, HitsAPlateAtHalfItsHeight) {
  Surroundings surroundings;
  surroundings.scene.objects.push_back(
      {"plate", BoxShape{{4, 4, 0.1}}, test_support::shift(0, 0, 0.45)});
  EXPECT_NE(words(bare_world(GetParam(), surroundings).find_contact(ready(GetParam()))), "");
}

INSTANTIATE_TEST_SUITE_P(Robots, Model,
                         testing::Values("panda", "iiwa14", "iiwa7", "ur10e", "sawyer", "sara_like",
                                         "panda_lift", "iiwa14_lift"));

INSTANTIATE_TEST_SUITE_P(Robots, ModelOfCapsules,
                         testing::Values("panda", "iiwa14", "iiwa7", "ur10e", "sara_like",
                                         "planar_5r_a", "planar_5r_b", "planar_7r_c"));

class PlanarModel : public testing::TestWithParam<std::string> {};

TEST_P(PlanarModel, IsFreeWhenStraightAndMeetsItselfWhenRolledUp) {
  const Eigen::Index dof = test::model_chain(GetParam()).dof();
  CollisionWorld world = bare_world(GetParam());
  EXPECT_EQ(words(world.find_contact(Eigen::VectorXd::Zero(dof))), "");
  EXPECT_NE(words(world.find_contact(Eigen::VectorXd::Constant(dof, 2.8))), "");
}

INSTANTIATE_TEST_SUITE_P(Robots, PlanarModel,
                         testing::Values("planar_5r_a", "planar_5r_b", "planar_7r_c"));

TEST(Ur10e, FoldedOntoItselfCollides) {
  // The elbow bent as far as it goes: the wrist comes back to the shoulder.
  EXPECT_TRUE(bare_world("ur10e").collides(test_support::angles({0, -1.57, 3.0, 0, 0, 0})));
}

}  // namespace
}  // namespace kinship::collision::models_test
