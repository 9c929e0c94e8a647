#include "robots/collision/edge_prover.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "proto/types/failure.hpp"
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
  EXPECT_LE(proof.configurations, 32U);
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

/// Balls of 4 mm on both links sweep over a grain of 2 mm, which few configurations of an edge
/// touch.
TEST(EdgeProver, AGrainIsFoundWhereverItLiesInTheSweep) {
  geometry::RobotShapes shapes;
  for (int link = 1; link <= 2; ++link)
    shapes.shapes.push_back({link, SphereShape{0.002}, Eigen::Isometry3d::Identity()});
  for (int place = 0; place < 300; ++place) {
    const double angle = -0.95 + 1.9 * place / 300, radius_m = (1 + place % 2) * kLink_m;
    CollisionWorld world(
        toy_chain(2), shapes,
        around(box_at("grain", radius_m * cos(angle), radius_m * sin(angle), 0.002)));
    EdgeProver prover(world);
    EXPECT_FALSE(prover.prove(angles({-1, 0}), angles({1, 0})).is_free()) << "at " << angle;
  }
}

TEST(EdgeProver, AGrainOnALinkIsFoundWhereverAnotherSweepsOverIt) {
  for (int place = 0; place < 300; ++place) {
    const double angle = -0.95 + 1.9 * place / 300;
    geometry::RobotShapes shapes;
    shapes.shapes.push_back(
        {1, SphereShape{0.001}, shift(2 * kLink_m * cos(angle), 2 * kLink_m * sin(angle))});
    shapes.shapes.push_back({3, SphereShape{0.002}, Eigen::Isometry3d::Identity()});
    CollisionWorld world(toy_chain(3), shapes, {});
    EdgeProver prover(world);
    EXPECT_FALSE(prover.prove(angles({0, -1, 0}), angles({1, 1, 0})).is_free()) << "at " << angle;
  }
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
  EXPECT_TRUE(prover.are_clear(qs.leftCols(19), {.clearance_m = 0.9 * gap_m}));
  EXPECT_FALSE(prover.are_clear(qs, {.clearance_m = 0.9 * gap_m}));
  EXPECT_FALSE(prover.are_clear(qs.rightCols(2), {.clearance_m = 1.1 * gap_m}));
  EXPECT_EQ(world.checks(), 0U);
}

TEST(EdgeProver, RefusesWhatIsNoEdge) {
  CollisionWorld world = world_with({});
  EdgeProver prover(world);
  const auto q = angles({0, 0});
  EXPECT_THROW(prover.prove(angles({0}), q), std::invalid_argument);
  EXPECT_THROW(prover.prove(q, angles({0, std::numeric_limits<double>::quiet_NaN()})),
               std::invalid_argument);
  try {
    prover.prove(q, q, {.clearance_m = 0});
    ADD_FAILURE() << "a clearance of 0 m";
  } catch (const Failure& failure) {
    EXPECT_STREQ(failure.what(), "clearance is 0 m, must be from 1e-05 to 0.1 m");
  }
}

/// The third link folded back over a ball that the first one carries.
CollisionWorld folded_over_ball(double gap_m) {
  geometry::RobotShapes shapes = toy_shapes(3);
  const double ball_m = 0.1;
  shapes.shapes.push_back(
      {1, SphereShape{ball_m}, shift(-kLink_m / 2, kLink_m - kRadius_m - gap_m - ball_m)});
  return {toy_chain(3), shapes, {}};
}

TEST(EdgeProver, OfTheRobotsOwnLinksAskedIsAMillimetreAtMost) {
  const auto folded = angles({0, M_PI / 2, M_PI / 2});
  const EdgeProofOptions wide{.clearance_m = 0.02}, narrow{.clearance_m = 1e-4};
  CollisionWorld apart = folded_over_ball(0.004), near = folded_over_ball(0.0005);
  EdgeProver of_apart(apart), of_near(near);
  EXPECT_TRUE(of_apart.prove(folded, folded, wide).is_free());
  EXPECT_EQ(of_apart.clear_ahead(folded, wide), 1);
  EXPECT_TRUE(of_apart.find_near(folded, wide).empty());
  EXPECT_FALSE(of_near.prove(folded, folded, wide).is_free());
  EXPECT_EQ(of_near.clear_ahead(folded, wide), 0);
  const std::vector<NearPair> pairs = of_near.find_near(folded, wide);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs.front().first + "-" + pairs.front().second, "link3-link1");
  EXPECT_NEAR(pairs.front().clearance_m, 0.0005, 1.1e-4);
  EXPECT_EQ(pairs.front().asked_m, kOwnClearance_m);
  EXPECT_TRUE(of_near.prove(folded, folded, narrow).is_free());
}

TEST(EdgeProver, FindsAllThatIsTooNear) {
  Surroundings surroundings = around(box_at("touched", 0.3, 0));
  surroundings.scene.objects.push_back(box_at("near", 0.75, 0.05 + kRadius_m + 0.01));
  surroundings.scene.objects.push_back(box_at("far", 0.75, -0.05 - kRadius_m - 0.03));
  CollisionWorld world = world_with(surroundings);
  EdgeProver prover(world);
  const std::vector<NearPair> pairs = prover.find_near(angles({0, 0}), {.clearance_m = 0.02});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].first + "-" + pairs[0].second, "link2-near");
  EXPECT_NEAR(pairs[0].clearance_m, 0.01, 2e-4);
  EXPECT_EQ(pairs[0].asked_m, 0.02);
  EXPECT_EQ(pairs[1].first + "-" + pairs[1].second, "link1-touched");
  EXPECT_EQ(pairs[1].clearance_m, 0);
}

TEST(EdgeProver, TheLeastClearanceIsThatOfTheObstacles) {
  const double gap_m = 0.03;
  Surroundings surroundings = around(box_at("box", 0.75, 0.05 + kRadius_m + gap_m));
  surroundings.scene.objects.push_back(box_at("farther", 0.75, -0.05 - kRadius_m - 0.09));
  CollisionWorld world = world_with(surroundings);
  EdgeProver prover(world);
  Eigen::MatrixXd turn(2, 2 * kLanes);  // ends where it is nearest
  turn << Eigen::RowVectorXd::LinSpaced(turn.cols(), -0.05, 0),
      Eigen::RowVectorXd::Zero(turn.cols());
  EXPECT_NEAR(prover.least_clearance_m(turn), gap_m, 0.02 * gap_m);
  EXPECT_EQ(prover.least_clearance_m(angles({M_PI, 0})), kLargestRoom_m);
  EXPECT_EQ(prover.least_clearance_m(angles({0.1, 0})), 0);
  CollisionWorld folded = folded_over_ball(0.0005);
  EXPECT_EQ(EdgeProver(folded).least_clearance_m(angles({0, M_PI / 2, M_PI / 2})), kLargestRoom_m)
      << "own links are no obstacles";
  EXPECT_EQ(world.checks(), 0U);
}

}  // namespace
}  // namespace kinship::collision::edge_prover_test
