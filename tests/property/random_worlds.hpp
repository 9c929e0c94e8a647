#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/body.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/geometry/point_cloud.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/chain_parts.hpp"
#include "tests/support/random_chain.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {

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
    Eigen::Isometry3d T = random_pose(1, generator_);
    if (generator_() % 2 == 0)
      T.linear().setIdentity();
    T.translation() << number(-reach_m, reach_m), number(-reach_m, reach_m),
        number(-reach_m, reach_m);
    return T;
  }

  /// A closed box or loose triangles.
  Eigen::Matrix3Xd triangles() {
    if (generator_() % 2 == 0)
      return BoxMesh({number(0.05, 0.6), number(0.05, 0.6), number(0.05, 0.6)}).triangles();
    return Eigen::Matrix3Xd::NullaryExpr(3, 60, [&] { return number(-0.3, 0.3); });
  }

  std::mt19937_64& generator() { return generator_; }

 private:
  std::mt19937_64 generator_{17};
};

/// Joints, turning and sliding, with a link of one or two shapes each.
inline Robot random_robot(int joints, double sliding_share, Random& random) {
  const kinematics::Chain bare = random_chain(
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

/// The same with joints and links beside the chain that follow it.
inline Robot followed_robot(int joints, double sliding_share, Random& random) {
  Robot robot = random_robot(joints, sliding_share, random);
  kinematics::ChainParts parts = parts_of(robot.chain);
  parts.mimics = random_mimics(robot.chain, 5, 0.3, random.generator());
  for (const kinematics::MimicJoint& mimic : parts.mimics) {
    const auto link = static_cast<int>(parts.links.size());  // the first hangs on no joint
    parts.links.push_back({mimic.joint.name + "_link", link - 1,
                           Eigen::Isometry3d(Eigen::Translation3d(0, 0.02, 0)), mimic.before + 1});
    robot.shapes.shapes.push_back({link, random.shape(0.2), random.pose(0.1)});
  }
  return {"followed", kinematics::Chain(parts), std::move(robot.shapes)};
}

inline std::vector<Robot> robots(Random& random) {
  std::vector<Robot> all;
  for (const char* name :
       {"panda", "iiwa7", "iiwa14", "ur10e", "sawyer", "sara_like", "planar_5r_a", "planar_7r_c"}) {
    const kinematics::Chain chain = model_chain(name);
    all.push_back({name, chain, geometry::read_shapes(robot_model(name)).value_or_throw()});
  }
  for (const double sliding_share : {0.0, 0.0, 0.4, 0.4})
    all.push_back(random_robot(6, sliding_share, random));
  Random own;  // so that nothing else changes
  for (const double sliding_share : {0.0, 0.4})
    all.push_back(followed_robot(5, sliding_share, own));
  all.push_back(random_robot(6, 0.2, own));
  all.back().name = "spheres";
  geometry::RobotShapes& spheres = all.back().shapes;
  spheres.shapes.clear();
  for (int link = 0; link <= 6; ++link)
    for (int i = 0; i < 8; ++i)
      spheres.shapes.push_back({link, SphereShape{own.number(0.02, 0.06)}, own.pose(0.15)});
  return all;
}

inline collision::Surroundings random_surroundings(const kinematics::Chain& chain, Random& random) {
  collision::Surroundings around;
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

/// Surroundings in which what stands may touch: else every configuration would collide, which no
/// test of moving bodies wants.
inline collision::Surroundings allowing_standing_contacts(
    const std::vector<collision::Body>& bodies, collision::Surroundings around) {
  for (const auto& [a, b] : standing_pairs(bodies, around))
    if (touch(bodies[a].solid, bodies[a].T_joint_body, bodies[b].solid, bodies[b].T_joint_body))
      around.allowed_collisions.emplace_back(bodies[a].name, bodies[b].name);
  return around;
}

}  // namespace kinship::test
