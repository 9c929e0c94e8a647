// What the lanes say of a configuration against what FCL says: never free where it collides, never
// surely colliding where it is free.

#include "robots/collision/lane_world.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "tests/property/random_worlds.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/robots.hpp"

namespace kinship::collision::lane_world_test {
namespace {

using test::allowing_standing_contacts;
using test::Random;
using test::random_surroundings;
using test::Robot;
using test::robots;

constexpr int kScenes = 8;

struct Counts {
  int free = 0, colliding = 0, undecided = 0;
};

/// A robot among its surroundings as the lanes and as FCL see it; what stands may touch.
struct Worlds {
  Worlds(const RobotSolids& solids, Surroundings surroundings)
      : bodies(bodies_among(solids, surroundings)),
        around(allowing_standing_contacts(bodies, std::move(surroundings))),
        fcl(solids, around),
        lanes(solids.parts().chain, bodies, moving_pairs(bodies, solids.parts().checked, around)) {}

  std::vector<Body> bodies;
  Surroundings around;
  CollisionWorld fcl;
  LaneWorld lanes;
};

/// Compares sixteen configurations with what FCL says of each, for each instruction set.
void compare(Worlds& worlds, const Eigen::MatrixXd& qs, Counts& counts) {
  std::uint32_t collides = 0;
  for (int i = 0; i < kLanes; ++i)
    collides |= worlds.fcl.find_contact(qs.col(i)) ? 1U << i : 0U;
  // The world answers as FCL does, which it asks only for the pairs that the lanes leave open.
  for (Eigen::Index i = 0; i < kLanes;) {
    const bool collide = (collides >> i & 1U) != 0;
    Eigen::Index end = i + 1;
    while (end < kLanes && ((collides >> end & 1U) != 0) == collide)
      ++end;
    const auto rest = qs.rightCols(kLanes - i);
    ASSERT_EQ(collide ? worlds.fcl.colliding_ahead(rest) : worlds.fcl.free_ahead(rest), end - i);
    i = end;
  }
  const LaneAnswer all = worlds.lanes.ask(qs, LaneScope::All);
  ASSERT_TRUE(all.surely == 0 || collides != 0) << "says collision where FCL says none";
  ASSERT_TRUE(all.surely != 0 || (collides & ~all.maybe) == 0) << "says free where FCL says not";
  for (const LaneSet& set : lane_sets()) {
    const LaneAnswer answer = worlds.lanes.ask(qs, set);
    ASSERT_EQ(collides & ~answer.maybe, 0U) << set.name << " says free where FCL says collision";
    ASSERT_EQ(answer.surely & ~collides, 0U) << set.name << " says collision where FCL says free";
    ASSERT_EQ(answer.surely & ~answer.maybe, 0U);
    if (&set != &lane_sets().back())
      continue;
    counts.free += std::popcount(~answer.maybe & 0xFFFFU);
    counts.colliding += std::popcount(answer.surely);
    counts.undecided += std::popcount(answer.maybe & ~answer.surely);
  }
}

void try_in_scenes(const Robot& robot, int batches, Random& random) {
  const RobotSolids solids(robot.chain, robot.shapes);
  Counts counts;
  for (int scene = 0; scene < kScenes; ++scene) {
    Worlds worlds(solids, random_surroundings(robot.chain, random));
    Eigen::MatrixXd qs(robot.chain.dof(), kLanes);
    for (int batch = 0; batch < batches; ++batch) {
      // Beyond the limits too, and far round.
      const double spread = batch % 16 == 0 ? 5 : 1;
      for (int i = 0; i < kLanes; ++i)
        qs.col(i) = spread * test::random_configuration(robot.chain, random.generator());
      compare(worlds, qs, counts);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << robot.name << ", scene " << scene;
    }
  }
  std::printf("%-12s free %6d, colliding %6d, undecided %6d\n", robot.name.c_str(), counts.free,
              counts.colliding, counts.undecided);
  EXPECT_GT(counts.free + counts.colliding, counts.undecided) << robot.name;
}

TEST(LaneWorld, NeverSaysFreeWhereFclSaysCollision) {
  Random random;
  const int batches = test::is_long_run() ? 3000 : 650;  // 1 000 000 configurations
  for (const Robot& robot : robots(random))
    try_in_scenes(robot, batches, random);
}

/// A configuration of which no joint differs from q by more than its change: mostly at a corner.
Eigen::VectorXd one_near(const kinematics::Chain& chain, const Eigen::VectorXd& q,
                         const Eigen::VectorXd& change, Random& random) {
  Eigen::VectorXd other = q;
  for (Eigen::Index j = 0; j < q.size(); ++j)
    other[j] += std::clamp(random.number(-3, 3), -1.0, 1.0) * change[j];
  for (Eigen::Index j = 0; j < q.size(); ++j)  // what slides keeps within its limits
    if (chain.joints()[static_cast<std::size_t>(j)].type == kinematics::JointType::Prismatic)
      other[j] = std::clamp(other[j], chain.lower()[j], chain.upper()[j]);
  return other;
}

TEST(LaneWorld, WhereItSaysFreeOfAllThatIsNearNothingNearTouches) {
  constexpr int kBatches = 40, kNear = 12;
  Random random;
  for (const Robot& robot : robots(random)) {
    const RobotSolids solids(robot.chain, robot.shapes);
    int free = 0;
    for (int scene = 0; scene < kScenes; ++scene) {
      Worlds worlds(solids, random_surroundings(robot.chain, random));
      Eigen::MatrixXd qs(robot.chain.dof(), kLanes), changes = qs;
      for (int batch = 0; batch < kBatches; ++batch) {
        const double most = std::pow(10, random.number(-2.5, -0.5));
        for (int i = 0; i < kLanes; ++i) {
          qs.col(i) = test::random_configuration(robot.chain, random.generator());
          for (Eigen::Index j = 0; j < qs.rows(); ++j)
            changes(j, i) = random.number(0, 1) < 0.5 ? 0 : random.number(-most, most);
        }
        const LaneAnswer answer = worlds.lanes.ask_grown(qs, changes, {}, LaneScope::Each);
        for (int i = 0; i < kLanes; ++i) {
          if ((answer.maybe >> i & 1U) != 0)
            continue;
          ++free;
          for (int k = 0; k < kNear; ++k) {
            const Eigen::VectorXd near =
                one_near(robot.chain, qs.col(i), changes.col(i).cwiseAbs(), random);
            ASSERT_FALSE(worlds.fcl.find_contact(near)) << robot.name << ", scene " << scene;
          }
        }
      }
    }
    std::printf("%-12s free with all that is near %5d\n", robot.name.c_str(), free);
    EXPECT_GT(free, 20) << robot.name;
  }
}

/// A bar that is tilted a little over the rim of a round table and reaches into it: directions
/// next to the table's axis are where floats are at their worst.
TEST(LaneWorld, ABarIsNotFreeOfTheRimThatItTouches) {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.links = {{"base", -1, Eigen::Isometry3d::Identity(), -1},
                 {"bar", 1, Eigen::Isometry3d::Identity(), 0}};
  kinematics::Joint tilt, lift;
  tilt.name = "tilt";
  tilt.axis = Eigen::Vector3d::UnitY();
  tilt.lower = -1;
  tilt.upper = 1;
  lift.name = "lift";
  lift.type = kinematics::JointType::Prismatic;
  lift.lower = -0.1;
  lift.upper = 0.1;
  parts.joints = {tilt, lift};
  parts.tip_link = "bar";
  const kinematics::Chain chain(parts);
  const double radius = 0.5, half_height = 0.02, half_bar = 0.03;
  const geometry::RobotShapes shapes{
      {{1, BoxShape{{0.4, 0.1, 2 * half_bar}}, Eigen::Isometry3d::Identity()}}, {}};
  Surroundings around;
  const Eigen::Vector3d table(0.6, 0, -half_height - half_bar);
  around.scene.objects.push_back({"table", CylinderShape{radius, 2 * half_height},
                                  Eigen::Isometry3d(Eigen::Translation3d(table))});
  Worlds worlds(RobotSolids(chain, shapes), around);
  int touching = 0;
  for (double angle = -4e-4; angle <= 4e-4; angle += 1e-5) {
    Eigen::MatrixXd qs(2, kLanes);
    for (int i = 0; i < kLanes; ++i)
      qs.col(i) << angle, -1e-4 + 1.5e-5 * i;
    for (const LaneSet& set : lane_sets()) {
      const LaneAnswer answer = worlds.lanes.ask(qs, set);
      for (int i = 0; i < kLanes; ++i)
        if (worlds.fcl.find_contact(qs.col(i))) {
          ++touching;
          ASSERT_NE(answer.maybe >> i & 1U, 0U) << set.name << ", " << qs.col(i).transpose();
        }
    }
  }
  EXPECT_GT(touching, 200);
}

kinematics::Joint axis_joint(const std::string& name, kinematics::JointType type,
                             const Eigen::Vector3d& axis) {
  kinematics::Joint joint;
  joint.name = name;
  joint.type = type;
  joint.axis = axis;
  joint.lower = -2;
  joint.upper = 2;
  return joint;
}

/// A box that slides and turns freely.
kinematics::Chain free_box_chain() {
  using kinematics::JointType;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "box";
  parts.links = {{"base", -1, Eigen::Isometry3d::Identity(), -1},
                 {"box", 5, Eigen::Isometry3d::Identity(), 0}};
  parts.joints = {
      axis_joint("x", JointType::Prismatic, x),    axis_joint("y", JointType::Prismatic, y),
      axis_joint("z", JointType::Prismatic, z),    axis_joint("yaw", JointType::Revolute, z),
      axis_joint("pitch", JointType::Revolute, y), axis_joint("roll", JointType::Revolute, x)};
  return kinematics::Chain(parts);
}

/// Where a box that comes along x first touches: between a free and a colliding place.
double contact_of(CollisionWorld& world, Eigen::VectorXd q) {
  double free = -2, colliding = 0;
  for (int halving = 0; halving < 24; ++halving) {
    q[0] = (free + colliding) / 2;
    (world.find_contact(q) ? colliding : free) = q[0];
  }
  return colliding;
}

/// Boxes next to touching whose edges are nearly parallel, where planes across two edges are at
/// their worst, and which the lanes call colliding without FCL.
TEST(LaneWorld, NearlyParallelBoxesTouchWhereFclSaysSo) {
  const kinematics::Chain chain = free_box_chain();
  const geometry::RobotShapes shapes{
      {{1, BoxShape{{0.2, 0.1, 0.5}}, Eigen::Isometry3d::Identity()}}, {}};
  Surroundings around;
  around.scene.objects.push_back({"box", BoxShape{{0.3, 0.4, 0.6}}, Eigen::Isometry3d::Identity()});
  Worlds worlds(RobotSolids(chain, shapes), around);
  Random random;
  Counts counts;
  for (int batch = 0; batch < 3000; ++batch) {
    const double tilt = std::pow(10, random.number(-7, -1));
    Eigen::VectorXd q(6);
    q << 0, random.number(-0.25, 0.25), random.number(-0.5, 0.5), random.number(-1.5, 1.5),
        random.number(-tilt, tilt), random.number(-tilt, tilt);
    if (batch % 3 == 0)
      q[3] = random.number(-tilt, tilt);
    const double contact = contact_of(worlds.fcl, q);
    Eigen::MatrixXd qs = q.replicate(1, kLanes);
    for (int i = 0; i < kLanes; ++i)
      qs(0, i) = contact + std::pow(10, random.number(-6, -1)) * (i % 2 == 0 ? 1 : -1);
    compare(worlds, qs, counts);
    ASSERT_FALSE(HasFatalFailure()) << q.transpose();
  }
  EXPECT_GT(counts.colliding, 10'000);
  EXPECT_GT(counts.free, 10'000);
}

}  // namespace
}  // namespace kinship::collision::lane_world_test
