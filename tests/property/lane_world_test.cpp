// What the lanes say of a configuration against what FCL says: never free where it collides, never
// surely colliding where it is free.

#include "robots/collision/lane_world.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/long_run.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

namespace kinship::collision::lane_world_test {
namespace {

constexpr std::uint64_t kSeed = 17;
constexpr int kScenes = 8;

struct Robot {
  std::string name;
  kinematics::Chain chain;
  geometry::RobotShapes shapes;
};

class Random {
 public:
  double number(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(generator_);
  }

  Shape shape(double most_m) {
    const auto size = [&] { return 0.01 + most_m * std::pow(number(0, 1), 2); };
    switch (generator_() % 4) {
      case 0:
        return BoxShape{{size(), size(), size()}};
      case 1:
        return CylinderShape{size() / 2, size()};
      case 2:
        return SphereShape{size() / 2};
      default:
        return CapsuleShape{size() / 2, size()};
    }
  }

  /// Every second one stands as its frame does: faces lie flat against each other there.
  Eigen::Isometry3d pose(double reach_m) {
    Eigen::Isometry3d T = test::random_pose(1, generator_);
    if (generator_() % 2 == 0)
      T.linear().setIdentity();
    T.translation() << number(-reach_m, reach_m), number(-reach_m, reach_m),
        number(-reach_m, reach_m);
    return T;
  }

  /// A closed box or loose triangles.
  Eigen::Matrix3Xd triangles() {
    if (generator_() % 2 == 0)
      return test::BoxMesh({number(0.05, 0.6), number(0.05, 0.6), number(0.05, 0.6)}).triangles();
    return Eigen::Matrix3Xd::NullaryExpr(3, 60, [&] { return number(-0.3, 0.3); });
  }

  std::mt19937_64& generator() { return generator_; }

 private:
  std::mt19937_64 generator_{kSeed};
};

/// Joints, turning and sliding, with a link of one or two shapes each.
Robot random_robot(int joints, double sliding_share, Random& random) {
  const kinematics::Chain bare = test::random_chain(
      {.joints = joints, .length_m = 0.3, .sliding_share = sliding_share}, random.generator());
  kinematics::ChainParts parts;
  parts.base_link = "link0";
  parts.joints = bare.joints();
  parts.T_last_tip = bare.T_last_tip();
  parts.T_tip_transfer = bare.T_tip_transfer();
  geometry::RobotShapes shapes;
  for (int link = 0; link <= joints; ++link) {
    parts.links.push_back({"link" + std::to_string(link), link - 1,
                           Eigen::Isometry3d(Eigen::Translation3d(0.02, 0, 0)), link - 1});
    for (std::uint64_t left = 1 + random.generator()() % 2; left > 0; --left)
      shapes.shapes.push_back({link, random.shape(0.2), random.pose(0.1)});
  }
  parts.tip_link = parts.links.back().name;
  return {"random", kinematics::Chain(parts), std::move(shapes)};
}

std::vector<Robot> robots(Random& random) {
  std::vector<Robot> all;
  for (const char* name :
       {"panda", "iiwa7", "iiwa14", "ur10e", "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"}) {
    const kinematics::Chain chain = test::model_chain(name);
    all.push_back({name, chain,
                   geometry::read_shapes(test::model_description(name), chain).value_or_throw()});
  }
  for (const double sliding_share : {0.0, 0.0, 0.4, 0.4})
    all.push_back(random_robot(6, sliding_share, random));
  return all;
}

Surroundings random_surroundings(const kinematics::Chain& chain, Random& random) {
  Surroundings around;
  around.T_task_base = random.pose(0.5);
  // What stands square does so in the base's frame, or in the task's, turned against that.
  Eigen::Isometry3d T_task_scene = around.T_task_base;
  if (random.generator()() % 2 == 0)
    T_task_scene.linear().setIdentity();
  for (int i = 0; i < 10; ++i)
    around.scene.objects.push_back(
        {"object" + std::to_string(i), random.shape(0.5), T_task_scene * random.pose(1.2)});
  Mesh mesh;
  mesh.file = "mesh";
  mesh.triangles = std::make_shared<const Eigen::Matrix3Xd>(random.triangles());
  around.scene.meshes.push_back({"mesh", mesh, T_task_scene * random.pose(0.8)});
  Eigen::Matrix3Xd points =
      Eigen::Matrix3Xd::NullaryExpr(3, 2000, [&] { return random.number(-0.3, 0.3); });
  points.row(2) *= 0.1;
  PointCloud cloud{"cloud", random.number(0.005, 0.05)};
  cloud.voxels = std::make_shared<const Eigen::Matrix3Xd>(
      geometry::voxels_of(points, cloud.voxel_m).value_or_throw());
  around.scene.clouds.push_back({"cloud", cloud, T_task_scene * random.pose(0.8)});
  AttachedObject held;
  held.name = "held";
  held.link = chain.tip_link();
  held.shape = random.shape(0.2);
  held.T_link_object = chain.T_tip_transfer() * random.pose(0.1);
  held.touch_links = {chain.tip_link()};
  around.attached.push_back(held);
  return around;
}

/// What stands in an obstacle would make every configuration collide, which is not the lanes'
/// business.
void allow_standing_contacts(const std::vector<Body>& bodies, Surroundings& around) {
  for (const auto& [a, b] : standing_pairs(bodies, around))
    if (touch(bodies[a].solid, bodies[a].T_joint_body, bodies[b].solid, bodies[b].T_joint_body))
      around.allowed_collisions.emplace_back(bodies[a].name, bodies[b].name);
}

struct Counts {
  int free = 0, colliding = 0, undecided = 0;
};

/// Compares sixteen configurations with what FCL says of each, for each instruction set.
void compare(LaneWorld& lanes, CollisionWorld& world, const Eigen::MatrixXd& qs, Counts& counts) {
  std::uint32_t collides = 0;
  for (int i = 0; i < kLanes; ++i)
    collides |= world.find_contact(qs.col(i)) ? 1U << i : 0U;
  // The world answers as FCL does, which it asks only for the pairs that the lanes leave open.
  for (Eigen::Index i = 0; i < kLanes;) {
    const bool collide = (collides >> i & 1U) != 0;
    Eigen::Index end = i + 1;
    while (end < kLanes && ((collides >> end & 1U) != 0) == collide)
      ++end;
    const auto rest = qs.rightCols(kLanes - i);
    ASSERT_EQ(collide ? world.colliding_ahead(rest) : world.free_ahead(rest), end - i);
    i = end;
  }
  for (const LaneSet& set : lane_sets()) {
    const LaneAnswer answer = lanes.ask(qs, set);
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
    Surroundings around = random_surroundings(robot.chain, random);
    std::vector<Body> bodies = solids.parts().bodies;
    add_surroundings(robot.chain, around, bodies);
    allow_standing_contacts(bodies, around);
    CollisionWorld world(solids, around);
    LaneWorld lanes(robot.chain, bodies, moving_pairs(bodies, solids.parts().unchecked, around));
    Eigen::MatrixXd qs(robot.chain.dof(), kLanes);
    for (int batch = 0; batch < batches; ++batch) {
      // Beyond the limits too, and far round.
      const double spread = batch % 16 == 0 ? 5 : 1;
      for (int i = 0; i < kLanes; ++i)
        qs.col(i) = spread * test::random_configuration(robot.chain, random.generator());
      compare(lanes, world, qs, counts);
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
  const RobotSolids solids(chain, shapes);
  CollisionWorld world(solids, around);
  std::vector<Body> bodies = solids.parts().bodies;
  add_surroundings(chain, around, bodies);
  LaneWorld lanes(chain, bodies, moving_pairs(bodies, solids.parts().unchecked, around));
  int touching = 0;
  for (double angle = -4e-4; angle <= 4e-4; angle += 1e-5) {
    Eigen::MatrixXd qs(2, kLanes);
    for (int i = 0; i < kLanes; ++i)
      qs.col(i) << angle, -1e-4 + 1.5e-5 * i;
    for (const LaneSet& set : lane_sets()) {
      const LaneAnswer answer = lanes.ask(qs, set);
      for (int i = 0; i < kLanes; ++i)
        if (world.find_contact(qs.col(i))) {
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
  const RobotSolids solids(chain, shapes);
  CollisionWorld world(solids, around);
  std::vector<Body> bodies = solids.parts().bodies;
  add_surroundings(chain, around, bodies);
  LaneWorld lanes(chain, bodies, moving_pairs(bodies, solids.parts().unchecked, around));
  Random random;
  Counts counts;
  for (int batch = 0; batch < 3000; ++batch) {
    const double tilt = std::pow(10, random.number(-7, -1));
    Eigen::VectorXd q(6);
    q << 0, random.number(-0.25, 0.25), random.number(-0.5, 0.5), random.number(-1.5, 1.5),
        random.number(-tilt, tilt), random.number(-tilt, tilt);
    if (batch % 3 == 0)
      q[3] = random.number(-tilt, tilt);
    const double contact = contact_of(world, q);
    Eigen::MatrixXd qs = q.replicate(1, kLanes);
    for (int i = 0; i < kLanes; ++i)
      qs(0, i) = contact + std::pow(10, random.number(-6, -1)) * (i % 2 == 0 ? 1 : -1);
    compare(lanes, world, qs, counts);
    ASSERT_FALSE(HasFatalFailure()) << q.transpose();
  }
  EXPECT_GT(counts.colliding, 10'000);
  EXPECT_GT(counts.free, 10'000);
}

}  // namespace
}  // namespace kinship::collision::lane_world_test
