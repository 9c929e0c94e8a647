// An edge that is called free touches nothing, however closely one looks; one that has room is not
// refused.

#include "robots/collision/edge_prover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/property/random_worlds.hpp"
#include "tests/support/long_run.hpp"

namespace kinship::collision::edge_prover_test {
namespace {

using test::Random;
using test::Robot;

constexpr int kScenes = 4;
constexpr double kStep = 0.05;    // joint units: how far apart edges are looked at without a proof
constexpr double kDense = 1e-3;   // the same for what is held to be true
constexpr double kDenser = 1e-4;  // where kRoom_m is missing: half of kDense moves no body so far
constexpr double kRoom_m = 5e-3;  // an edge with so much is not to be refused

/// Three sliding joints and a wrist, with a tool 10 mm thick.
constexpr const char* kGantry = R"(<robot name="gantry">
  <link name="base"><collision><origin xyz="0 0 -0.6"/><geometry><box size="0.3 0.3 0.1"/></geometry></collision></link>
  <link name="beam"><collision><origin xyz="0 0 0.5"/><geometry><box size="0.06 2.2 0.06"/></geometry></collision></link>
  <link name="cart"><collision><origin xyz="0 0 0.62"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="mast"><collision><origin xyz="0.1 0 0.3"/><geometry><cylinder radius="0.005" length="0.6"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.01 0.1 0.04"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="base"/><child link="beam"/><axis xyz="1 0 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="y" type="prismatic"><parent link="beam"/><child link="cart"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="z" type="prismatic"><parent link="cart"/><child link="mast"/><axis xyz="0 0 1"/>
    <limit lower="-0.4" upper="0.2" effort="1" velocity="1"/></joint>
  <joint name="wrist" type="continuous"><parent link="mast"/><child link="tool"/><origin xyz="0.1 0 -0.05"/><axis xyz="0 0 1"/></joint>
</robot>)";

/// A lift that turns and reaches out, with a hinge at its end.
constexpr const char* kReacher = R"(<robot name="reacher">
  <link name="base"><collision><origin xyz="0 0 -0.2"/><geometry><cylinder radius="0.15" length="0.1"/></geometry></collision></link>
  <link name="lift"><collision><geometry><cylinder radius="0.08" length="0.1"/></geometry></collision></link>
  <link name="turn"><collision><origin xyz="0.2 0 0.1"/><geometry><box size="0.4 0.06 0.06"/></geometry></collision></link>
  <link name="slide"><collision><origin xyz="0.2 0 0.2"/><geometry><box size="0.4 0.04 0.04"/></geometry></collision></link>
  <link name="hinge"><collision><origin xyz="0.1 0 0"/><geometry><cylinder radius="0.02" length="0.2"/></geometry></collision></link>
  <joint name="up" type="prismatic"><parent link="base"/><child link="lift"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="around" type="revolute"><parent link="lift"/><child link="turn"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="out" type="prismatic"><parent link="turn"/><child link="slide"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
  <joint name="tilt" type="revolute"><parent link="slide"/><child link="hinge"/><origin xyz="0.45 0 0.2"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
</robot>)";

Robot robot_of(const std::string& name, const char* urdf, const std::string& tip) {
  RobotDescription description;
  description.label = name;
  description.urdf = urdf;
  description.base_link = "base";
  description.tip_link = tip;
  const kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  return {
      name, chain,
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw()};
}

/// Those of the lanes' test, all others of robots/models, two that slide, one with a mesh.
std::vector<Robot> all_robots(Random& random) {
  std::vector<Robot> all = test::robots(random);
  const kinematics::Chain chain = test::model_chain("planar_5r_b");
  all.push_back({"planar_5r_b", chain,
                 geometry::read_shapes(test::robot_model("planar_5r_b")).value_or_throw()});
  all.push_back(robot_of("gantry", kGantry, "tool"));
  all.push_back(robot_of("reacher", kReacher, "hinge"));
  Robot meshes = all.front();
  meshes.name = "panda, mesh";
  geometry::LinkShape& hand = meshes.shapes.shapes.back();
  const Eigen::Vector3d size(0.1, 0.12, 0.14);
  hand.shape = BoxShape{size};
  hand.triangles = std::make_shared<const Eigen::Matrix3Xd>(
      test::BoxMesh(size).triangles().colwise() - size / 2);
  all.push_back(meshes);
  return all;
}

Shape grown(const Shape& shape, double by_m) {
  if (const auto* box = std::get_if<BoxShape>(&shape))
    return BoxShape{box->size.array() + 2 * by_m};
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape))
    return CylinderShape{cylinder->radius_m + by_m, cylinder->length_m + 2 * by_m};
  if (const auto* sphere = std::get_if<SphereShape>(&shape))
    return SphereShape{sphere->radius_m + by_m};
  const auto& capsule = std::get<CapsuleShape>(shape);
  return CapsuleShape{capsule.radius_m + by_m, capsule.length_m};
}

/// A robot and what it holds, with so much around them: where these are free, there is room.
/// Meshes become what they lie in.
Robot grown(Robot robot, double by_m) {
  for (geometry::LinkShape& shape : robot.shapes.shapes) {
    shape.shape = grown(shape.shape, by_m);
    shape.triangles = nullptr;
  }
  return robot;
}

Surroundings grown(Surroundings around, double by_m) {
  for (AttachedObject& held : around.attached)
    held.shape = grown(held.shape, by_m);
  return around;
}

Eigen::MatrixXd line(const Eigen::VectorXd& from, const Eigen::VectorXd& to, double step) {
  const double longest = (to - from).cwiseAbs().maxCoeff();
  const auto parts =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(std::ceil(longest / step)));
  Eigen::MatrixXd qs(from.size(), parts + 1);
  for (Eigen::Index i = 0; i <= parts; ++i)
    qs.col(i) = from + (to - from) * static_cast<double>(i) / static_cast<double>(parts);
  return qs;
}

bool is_free(CollisionWorld& world, const Eigen::MatrixXd& qs) {
  return world.free_ahead(qs) == qs.cols();
}

struct Counts {
  int edges = 0, free = 0, with_room = 0, refused_with_room = 0;
};

/// What is asked about one edge. \param roomy  the world in which robot and load are grown
void look_at(EdgeProver& prover, CollisionWorld& world, CollisionWorld& roomy,
             const Eigen::VectorXd& from, const Eigen::VectorXd& to, Counts& counts) {
  const EdgeProof proof = prover.prove(from, to);
  ++counts.edges;
  counts.free += proof.is_free() ? 1 : 0;
  const Eigen::MatrixXd dense = line(from, to, kDense);
  const bool truly_free = is_free(world, dense);
  const bool has_room = truly_free && is_free(roomy, dense);
  if (proof.is_free()) {
    ASSERT_TRUE(truly_free && (has_room || is_free(world, line(from, to, kDenser))))
        << "called free: " << from.transpose() << " to " << to.transpose();
  } else {
    const EdgeRefutation& found = *proof.refutation;
    ASSERT_LE(found.clearance_m, EdgeProofOptions{}.clearance_m);
    ASSERT_LT((from + found.share * (to - from) - found.q).norm(), 1e-9);
    ASSERT_TRUE(roomy.find_contact(found.q)) << found.first << ", " << found.second;
  }
  if (has_room) {
    ++counts.with_room;
    counts.refused_with_room += proof.is_free() ? 0 : 1;
  }
}

/// Another configuration: near, far or along one joint.
Eigen::VectorXd other_end(const kinematics::Chain& chain, const Eigen::VectorXd& from,
                          Random& random) {
  Eigen::VectorXd change = test::random_configuration(chain, random.generator()) - from;
  if (random.generator()() % 3 == 0) {
    const auto joint =
        static_cast<Eigen::Index>(random.generator()() % static_cast<std::uint64_t>(chain.dof()));
    const double alone = change[joint];
    change.setZero();
    change[joint] = alone;
  }
  return from + std::pow(10, random.number(-1.5, 0)) * change;
}

/// Every second scene is of shapes only.
void try_in_scenes(const Robot& robot, int edges, Random& random, Counts& counts) {
  const RobotSolids solids(robot.chain, robot.shapes), roomy_solids = [&] {
    const Robot roomy = grown(robot, kRoom_m);
    return RobotSolids(roomy.chain, roomy.shapes);
  }();
  for (int scene = 0; scene < kScenes; ++scene) {
    Surroundings around = test::random_surroundings(robot.chain, random);
    if (scene % 2 == 1) {
      around.scene.meshes.clear();
      around.scene.clouds.clear();
    }
    // What stands within the room would make every configuration collide.
    const std::vector<Body> bodies = bodies_among(roomy_solids, grown(around, kRoom_m));
    around = test::allowing_standing_contacts(bodies, std::move(around));
    CollisionWorld world(solids, around), roomy_world(roomy_solids, grown(around, kRoom_m));
    EdgeProver prover(world);
    for (int edge = 0, tries = 0; edge < edges && tries < 100 * edges; ++tries) {
      const Eigen::VectorXd from = test::random_configuration(robot.chain, random.generator());
      if (world.find_contact(from))
        continue;
      look_at(prover, world, roomy_world, from, other_end(robot.chain, from, random), counts);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << robot.name << ", scene " << scene;
      ++edge;
    }
  }
}

TEST(EdgeProver, AFreeEdgeTouchesNothingAndRoomIsNotRefused) {
  Random random;
  const int edges = test::is_long_run() ? 17'000 : 150;
  Counts all;
  for (const Robot& robot : all_robots(random)) {
    try_in_scenes(robot, edges, random, all);
    ASSERT_FALSE(HasFatalFailure());
  }
  EXPECT_GT(all.free, all.edges / 10);
  EXPECT_LT(all.free, all.edges);
  EXPECT_GT(all.with_room, all.edges / 20);
  EXPECT_LE(all.refused_with_room, all.with_room / 50);
}

/// The plate stands across all that the tool can reach. Both are thinner than a step.
TEST(EdgeProver, NoEdgeOfAGantryCrossesASealedPlate) {
  const Robot robot = robot_of("gantry", kGantry, "tool");
  Surroundings around;
  around.scene.objects.push_back(
      {"plate", BoxShape{{0.02, 4, 1.2}}, Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0.0))});
  around.allowed_collisions = {{"base", "plate"}, {"beam", "plate"}, {"cart", "plate"}};
  const RobotSolids solids(robot.chain, robot.shapes);
  CollisionWorld world(solids, around);
  EdgeProver prover(world);
  Random random;
  int missed_by_steps = 0, beside = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto side = [&](double lower, double upper) {
      Eigen::VectorXd q(4);
      q << random.number(lower, upper), random.number(-1, 1), random.number(-0.4, 0.2), 0;
      return q;
    };
    const Eigen::VectorXd before = side(-1, -0.09), behind = side(0.09, 1);
    const EdgeProof across = prover.prove(before, behind);
    ASSERT_FALSE(across.is_free()) << before.transpose() << " to " << behind.transpose();
    EXPECT_EQ(across.refutation->first, "plate");
    missed_by_steps += is_free(world, line(before, behind, kStep)) ? 1 : 0;
    beside += prover.prove(before, side(-1, -0.09)).is_free() ? 1 : 0;
  }
  EXPECT_EQ(beside, 1000);
  EXPECT_GT(missed_by_steps, 0);
}

/// A millimetre beside the plate counts as touching, two do not.
TEST(EdgeProver, AnEdgeAlongAPlateIsFreeAtTwoMillimetres) {
  const Robot robot = robot_of("gantry", kGantry, "tool");
  Surroundings around;
  around.scene.objects.push_back(
      {"plate", BoxShape{{0.02, 4, 1.2}}, Eigen::Isometry3d(Eigen::Translation3d(0.1, 0, 0.0))});
  around.allowed_collisions = {{"base", "plate"}, {"beam", "plate"}, {"cart", "plate"}};
  CollisionWorld world(robot.chain, robot.shapes, around);
  EdgeProver prover(world);
  for (const double gap_m : {0.0005, 0.002, 0.02}) {
    Eigen::VectorXd from(4), to(4);
    from << -0.015 - gap_m, -1, 0, 0;
    to << -0.015 - gap_m, 1, 0.1, 0;
    const EdgeProof proof = prover.prove(from, to);
    EXPECT_EQ(proof.is_free(), gap_m > 0.001) << gap_m;
    if (gap_m < 0.01) {  // else the lanes tell that it is far enough
      EXPECT_NEAR(proof.least_clearance_m, gap_m, 0.05 * gap_m + 1e-5) << gap_m;
    }
  }
}

}  // namespace
}  // namespace kinship::collision::edge_prover_test
