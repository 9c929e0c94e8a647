#include "robots/collision/edge_prover.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::edge_prover_test {
namespace {

using namespace test_support;

Surroundings around(const SceneObject& object) {
  Surroundings surroundings;
  surroundings.scene.objects = {object};
  return surroundings;
}

CollisionWorld world_with(const Surroundings& surroundings) {
  return {toy_chain(2), toy_shapes(2), surroundings};
}

TEST(EdgeProver, FarFromEverythingTheLanesAreEnough) {
  CollisionWorld world = world_with(around(box_at("box", 9, 0)));
  EdgeProver prover(world);
  const EdgeProof proof = prover.prove(angles({-0.5, 0}), angles({0.5, 0}));
  EXPECT_TRUE(proof.is_free());
  EXPECT_LE(proof.configurations, 16U);
  EXPECT_EQ(proof.distances, 0U);
  EXPECT_EQ(proof.least_clearance_m, std::numeric_limits<double>::infinity());
}

TEST(EdgeProver, NamesWhatStandsInTheWay) {
  CollisionWorld world = world_with(around(box_at("post", 0.75, 0, 0.01)));
  EdgeProver prover(world);
  const EdgeProof proof = prover.prove(angles({-1, 0}), angles({1, 0}));
  ASSERT_FALSE(proof.is_free());
  EXPECT_EQ(proof.refutation->first, "post");
  EXPECT_EQ(proof.refutation->second, "link2");
  EXPECT_NEAR(proof.refutation->q[0], 2 * proof.refutation->share - 1, 1e-12);
  EXPECT_LE(proof.refutation->clearance_m, EdgeProofOptions{}.clearance_m);
}

TEST(EdgeProver, AStandingContactRefutesEveryEdge) {
  Surroundings surroundings = around(box_at("table", 0, 0));
  geometry::RobotShapes shapes = toy_shapes(2);
  shapes.shapes.push_back({0, SphereShape{0.05}, Eigen::Isometry3d::Identity()});
  CollisionWorld world(toy_chain(2), shapes, surroundings);
  EdgeProver prover(world);
  const EdgeProof proof = prover.prove(angles({0, 0}), angles({0, 0}));
  ASSERT_FALSE(proof.is_free());
  EXPECT_EQ(proof.refutation->first, "base");
  EXPECT_EQ(proof.refutation->second, "table");
}

/// A box beside the stretched arm, which turns by nothing: what counts is the clearance asked for.
TEST(EdgeProver, ClearanceIsWhatCountsAsTouching) {
  const double gap_m = 0.01;
  CollisionWorld world = world_with(around(box_at("box", 0.75, 0.05 + kRadius_m + gap_m)));
  EdgeProver prover(world);
  const auto still = angles({0, 0});
  EXPECT_TRUE(prover.prove(still, still, {.clearance_m = 0.9 * gap_m}).is_free());
  const EdgeProof proof = prover.prove(still, still, {.clearance_m = 1.1 * gap_m});
  ASSERT_FALSE(proof.is_free());
  EXPECT_NEAR(proof.refutation->clearance_m, gap_m, 0.02 * gap_m);
  EXPECT_EQ(proof.least_clearance_m, proof.refutation->clearance_m);
}

TEST(EdgeProver, TellsHowManyAreClear) {
  const double gap_m = 0.01;
  CollisionWorld world = world_with(around(box_at("box", 0.75, 0.05 + kRadius_m + gap_m)));
  EdgeProver prover(world);
  Eigen::MatrixXd qs(2, 20);
  for (Eigen::Index i = 0; i < qs.cols(); ++i)
    qs.col(i) << 0.01 * (static_cast<double>(i) - 18), 0;
  EXPECT_EQ(prover.clear_ahead(qs, {.clearance_m = 0.9 * gap_m}), 19);
  EXPECT_EQ(prover.clear_ahead(qs.rightCols(2), {.clearance_m = 1.1 * gap_m}), 0);
  EXPECT_EQ(world.checks(), 0U);
}

TEST(EdgeProver, RefusesWhatIsNoEdge) {
  CollisionWorld world = world_with({});
  EdgeProver prover(world);
  const auto q = angles({0, 0});
  EXPECT_THROW(prover.prove(angles({0}), q), std::invalid_argument);
  EXPECT_THROW(prover.prove(q, angles({0, std::numeric_limits<double>::quiet_NaN()})),
               std::invalid_argument);
  EXPECT_THROW(prover.prove(q, q, {.clearance_m = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::collision::edge_prover_test
