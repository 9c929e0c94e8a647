#include "robots/collision/motion_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::motion_bounds_test {
namespace {

using namespace test_support;

constexpr std::uint64_t kSeed = 5;
constexpr int kParts = 40;

TEST(MotionBounds, AJointAloneMovesABodyByItsFarthestPoint) {
  const kinematics::Chain chain = toy_chain(2);
  const RobotSolids solids(chain, toy_shapes(2));
  const MotionBounds bounds(chain, solids.parts().bodies);
  const auto T_base_joints = kinematics::joint_poses(chain, angles({0.3, 0}));
  Eigen::VectorXd reach_m = Eigen::VectorXd::Zero(2), motion_m = Eigen::VectorXd::Zero(3);
  bounds.measure(1, T_base_joints, reach_m);
  EXPECT_NEAR(reach_m[0], 2 * kLink_m - 0.1 + kRadius_m, 1e-6);  // capsules end 0.1 m early
  EXPECT_NEAR(reach_m[1], kLink_m - 0.1 + kRadius_m, 1e-6);
  bounds.bound(1, angles({0.01, 0}), reach_m, reach_m, motion_m);
  EXPECT_NEAR(motion_m[0], 0.01 * reach_m[0], 1e-9);
  EXPECT_EQ(motion_m[1], 0) << "in the first link's frame nothing moves";
}

/// The moving joints before one, from it on, then the base.
std::vector<int> frames_of(const kinematics::Chain& chain, int joint) {
  std::vector<int> frames;
  for (; joint >= 0; joint = chain.joint_before(joint))
    frames.push_back(joint);
  frames.push_back(-1);
  return frames;
}

/// The corners of a box, one a link, on the way.
TEST(MotionBounds, NoPointMovesFartherInAnyFrame) {
  std::mt19937_64 generator(kSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  const Eigen::Vector3d size(0.1, 0.3, 0.2);
  double tightest = 0;
  for (int round = 0; round < 200; ++round) {
    kinematics::ChainParts parts = test::parts_of(
        test::random_chain({.joints = 5, .length_m = 0.3, .sliding_share = 0.3}, generator));
    parts.mimics = test::random_mimics(kinematics::Chain(parts), round % 4, 0.3, generator);
    const kinematics::Chain bare(parts);
    std::vector<Body> bodies;
    for (int joint = 0; joint < bare.moving_joints(); ++joint)
      bodies.push_back({BodyKind::Link,
                        "link",
                        joint,
                        joint,
                        test::random_pose(0.1, generator),
                        Solid(BoxShape{size}),
                        {}});
    const MotionBounds bounds(bare, bodies);
    const Eigen::VectorXd from = test::random_configuration(bare, generator);
    const Eigen::VectorXd change =
        std::pow(10, -2 * unit(generator)) * (test::random_configuration(bare, generator) - from);
    const auto at_start = kinematics::joint_poses(bare, from);
    const auto at_end = kinematics::joint_poses(bare, from + change);
    for (std::size_t body = 0; body < bodies.size(); ++body) {
      Eigen::VectorXd from_m = Eigen::VectorXd::Zero(bare.moving_joints()), to_m = from_m,
                      motion_m = Eigen::VectorXd::Zero(bare.moving_joints() + 1);
      bounds.measure(body, at_start, from_m);
      bounds.measure(body, at_end, to_m);
      bounds.bound(body, change, from_m, to_m, motion_m);
      for (int part = 0; part <= kParts; ++part) {
        const double share = static_cast<double>(part) / kParts;
        const auto here = kinematics::joint_poses(bare, from + share * change);
        for (const int frame : frames_of(bare, static_cast<int>(body)))
          for (int corner = 0; corner < 8; ++corner) {
            const Eigen::Vector3d p =
                bodies[body].T_joint_body * Eigen::Vector3d((corner & 1 ? 0.5 : -0.5) * size.x(),
                                                            (corner & 2 ? 0.5 : -0.5) * size.y(),
                                                            (corner & 4 ? 0.5 : -0.5) * size.z());
            const auto seen = [&](const std::vector<Eigen::Isometry3d>& T) -> Eigen::Vector3d {
              return frame < 0 ? T[body] * p
                               : T[static_cast<std::size_t>(frame)].inverse() * T[body] * p;
            };
            const double limit_m = motion_m[frame + 1];
            const double moved_m = (seen(here) - seen(at_start)).norm();
            ASSERT_LE(moved_m, share * limit_m + 1e-9) << "body " << body << ", frame " << frame;
            ASSERT_LE((seen(at_end) - seen(here)).norm(), (1 - share) * limit_m + 1e-9);
            if (limit_m > 0)
              tightest = std::max(tightest, moved_m / limit_m);
          }
      }
    }
  }
  EXPECT_GT(tightest, 0.9);
}

/// What turns beyond all numbers has no body: zero times that is not a number. A joint beside it,
/// looked at later, moves a little.
TEST(MotionBounds, AWayBeyondAllNumbersIsInfinite) {
  kinematics::ChainParts parts = test::parts_of(toy_chain(2));
  parts.mimics.push_back({parts.joints[0], -1, 0});
  parts.mimics.back().joint.name = "beside";
  const kinematics::Chain chain(parts);
  const MotionBounds bounds(
      chain, {{BodyKind::Link, "link", 2, 2, shift(1), Solid(SphereShape{0.1}), {}}});
  EXPECT_NEAR(bounds.farthest_m(angles({0, 0}), angles({0.1, 0})), 0.11, 1e-6);
  EXPECT_EQ(bounds.farthest_m(angles({0, -1e308}), angles({0.1, 1e308})),
            std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace kinship::collision::motion_bounds_test
