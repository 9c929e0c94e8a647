// The plugins without a server: found, planned with, and never waited for.

#include <octomap/octomap.h>

#include <array>
#include <set>
#include <sstream>

#include "tests/integration/kinship_moveit/pipeline.hpp"
#include "tests/support/server_process.hpp"

namespace kinship::kinship_moveit_test {
namespace {

class KINSHIP_FIXTURE : public PluginCell {
 protected:
  static Eigen::VectorXd turned(double base_rad) {
    return Eigen::VectorXd{{base_rad, 0.5, 0, -1.5, 0, 2, 0.785}};
  }
  /// The post of c_planning_test.cpp, as a box.
  static collision::Surroundings post() {
    collision::Surroundings surroundings;
    surroundings.scene.objects.push_back({"post", BoxShape{{0.05, 0.05, 0.8}},
                                          Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.4))});
    return surroundings;
  }
  /// Plans past the post, in a scene that has it as `shape` at T, where only Kinship knows of it.
  MotionPlanResponse plan_past(planning_interface::PlannerManager& planner,
                               shapes::ShapeConstPtr shape, const Eigen::Isometry3d& T,
                               const std::function<void(planning_scene::PlanningScene&)>& change) {
    const auto scene = empty_scene(turned(-0.7));
    add(*scene, "post", std::move(shape), T);
    if (change)
      change(*scene);
    MotionPlanResponse response;
    EXPECT_TRUE(comes_true([&] {
      response = solve(planner, scene, request(turned(0.7)));
      return error_code_of(response) != moveit_msgs::msg::MoveItErrorCodes::PLANNING_FAILED;
    }));
    return response;
  }
  static void set_orientation(const Eigen::Matrix3d& R,
                              moveit_msgs::msg::OrientationConstraint& constraint) {
    const Eigen::Quaterniond turn(R);
    constraint.orientation.x = turn.x();
    constraint.orientation.y = turn.y();
    constraint.orientation.z = turn.z();
    constraint.orientation.w = turn.w();
  }
  /// A request past the post that keeps the orientation of the hand where the base is turned.
  struct KeptOrientation {
    std::shared_ptr<planning_scene::PlanningScene> scene;
    Eigen::Matrix3d R_world_kept;
    MotionPlanRequest asked;
  };
  /// \param base_rad        of the orientation.
  /// \param tolerances_rad  about x, y and z.
  KeptOrientation keep_orientation(planning_interface::PlannerManager& planner, double base_rad,
                                   const Eigen::Vector3d& tolerances_rad) {
    const auto box = std::make_shared<shapes::Box>(0.05, 0.05, 0.8);
    const Eigen::Isometry3d T(Eigen::Translation3d(0.6, 0, 0.4));
    auto answer = plan_past(planner, box, T, {});
    EXPECT_NE(trajectory_of(answer), nullptr) << "the robot is read";
    KeptOrientation made{empty_scene(turned(-0.7)), {}, request(turned(0.7))};
    add(*made.scene, "post", box, T);
    moveit::core::RobotState state = made.scene->state;
    state.q = turned(base_rad);
    made.R_world_kept = state.getGlobalLinkTransform("hand").linear();
    auto& kept = made.asked.path_constraints.orientation_constraints.emplace_back();
    kept.link_name = "hand";  // which panda_link8 holds
    set_orientation(made.R_world_kept, kept);
    kept.absolute_x_axis_tolerance = tolerances_rad.x();
    kept.absolute_y_axis_tolerance = tolerances_rad.y();
    kept.absolute_z_axis_tolerance = tolerances_rad.z();
    return made;
  }
  bool is_past_the_post(MotionPlanResponse& response) const { return is_past(response, post()); }
  bool is_past(MotionPlanResponse& response, const collision::Surroundings& surroundings) const {
    if (trajectory_of(response) == nullptr)
      return false;
    collision::CollisionWorld world(cell_.solids, surroundings);
    for (std::size_t i = 0; i < trajectory_of(response)->getWayPointCount(); ++i)
      if (world.collides(trajectory_of(response)->getWayPoint(i).q))
        return false;
    return trajectory_of(response)->getWayPointCount() > 10;
  }
};

TEST_F(KINSHIP_FIXTURE, AreFoundByTheirDescription) {
  const auto names = [](const std::string& base, auto* type) {
    using Base = std::remove_pointer_t<decltype(type)>;
    return pluginlib::ClassLoader<Base>("moveit_core", base).getDeclaredClasses();
  };
  using Texts = std::vector<std::string>;
  constraint_samplers::ConstraintSamplerAllocator* allocator = nullptr;
  EXPECT_EQ(names("constraint_samplers::ConstraintSamplerAllocator", allocator),
            Texts{"kinship_moveit/SamplerAllocator"});
  EXPECT_NE(
      load<constraint_samplers::ConstraintSamplerAllocator>(
          "constraint_samplers::ConstraintSamplerAllocator", "kinship_moveit/SamplerAllocator"),
      nullptr);
  EXPECT_EQ(planner(node())->getDescription(), "Kinship");
  Pipeline pipeline(*this, node());
  EXPECT_NE(pipeline.description().find("Kinship"), std::string::npos);
}

TEST_F(KINSHIP_FIXTURE, PlanAroundBoxesMeshesAndOctomaps) {
  const auto planner = this->planner(node());
  const Eigen::Isometry3d T(Eigen::Translation3d(0.6, 0, 0.4));
  auto answer = plan_past(*planner, std::make_shared<shapes::Box>(0.05, 0.05, 0.8), T, {});
  EXPECT_TRUE(is_past_the_post(answer));

  auto mesh = std::make_shared<shapes::Mesh>(8, 12);
  for (unsigned int corner = 0; corner < 8; ++corner)
    for (unsigned int axis = 0; axis < 3; ++axis)
      mesh->vertices[3 * corner + axis] =
          ((corner >> axis) & 1U ? 0.5 : -0.5) * (axis == 2 ? 0.8 : 0.05);
  constexpr std::array<unsigned int, 36> kFaces = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6,
                                                   0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6,
                                                   0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
  std::copy(kFaces.begin(), kFaces.end(), mesh->triangles);
  answer = plan_past(*planner, mesh, T, {});
  EXPECT_TRUE(is_past_the_post(answer));

  auto tree = std::make_shared<octomap::OcTree>(0.025);
  for (double z = -0.3875; z < 0.4; z += 0.025)
    for (const double x : {-0.0125, 0.0125})
      for (const double y : {-0.0125, 0.0125})
        tree->updateNode(x, y, z, true);
  tree->prune();  // leaves of 5 cm
  answer = plan_past(*planner, std::make_shared<shapes::OcTree>(tree), T, {});
  EXPECT_TRUE(is_past_the_post(answer));

  // A block that is one leaf: whoever took its middle for all of it would touch the rest.
  tree = std::make_shared<octomap::OcTree>(0.0125);
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z)
        tree->updateNode(0.00625 + 0.0125 * x, 0.00625 + 0.0125 * y, 0.00625 + 0.0125 * z, true);
  tree->prune();
  ASSERT_EQ(tree->getNumLeafNodes(), 1U);
  collision::Surroundings block;
  block.scene.objects.push_back(
      {"block", BoxShape{{0.2, 0.2, 0.2}}, Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.4))});
  answer = plan_past(*planner, std::make_shared<shapes::OcTree>(tree),
                     Eigen::Isometry3d(Eigen::Translation3d(0.5, -0.1, 0.3)), {});
  EXPECT_TRUE(is_past(answer, block));
}

TEST_F(KINSHIP_FIXTURE, MatrixAndAttachedBodiesCount) {
  const auto planner = this->planner(node());
  const auto box = std::make_shared<shapes::Box>(0.05, 0.05, 0.8);
  const Eigen::Isometry3d T(Eigen::Translation3d(0.6, 0, 0.4));
  auto answer = plan_past(*planner, box, T, [&](planning_scene::PlanningScene& scene) {
    for (const std::string& link : model_->links_with_geometry)
      scene.matrix.entries[std::minmax<std::string>("post", link)] =
          collision_detection::AllowedCollision::ALWAYS;
  });
  ASSERT_NE(trajectory_of(answer), nullptr);
  EXPECT_FALSE(is_past_the_post(answer));  // straight through: they may touch

  // A rod in the hand, longer than the way over the post.
  const auto hold = [&](const std::string& link) {
    return [&, link](planning_scene::PlanningScene& scene) {
      moveit::core::AttachedBody rod;
      rod.name = "rod";
      rod.link = model_->getLinkModel(link);
      rod.shapes.push_back(std::make_shared<shapes::Cylinder>(0.01, 0.2));
      rod.T_link_shapes.push_back(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.2)));
      scene.state.attached.push_back(rod);
      scene.matrix.entries[{"hand", "rod"}] = collision_detection::AllowedCollision::ALWAYS;
    };
  };
  answer = plan_past(*planner, box, T, hold("hand"));
  ASSERT_TRUE(is_past_the_post(answer));
  collision::Surroundings held = post();
  held.attached.push_back({"rod",
                           "panda_link8",
                           CylinderShape{0.01, 0.2},
                           Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.2)),
                           {}});
  collision::CollisionWorld world(cell_.solids, held);
  for (std::size_t i = 0; i < trajectory_of(answer)->getWayPointCount(); ++i)
    EXPECT_FALSE(world.collides(trajectory_of(answer)->getWayPoint(i).q)) << i;

  testing::internal::CaptureStderr();
  answer = plan_past(*planner, box, T, hold("panda_link4"));
  EXPECT_EQ(trajectory_of(answer), nullptr);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("does not move with 'panda_link8'"), std::string::npos) << said;
}

TEST_F(KINSHIP_FIXTURE, AnObjectOfSeveralShapesIsPlannedForAndReported) {
  const auto planner = this->planner(node());
  const Eigen::Isometry3d T(Eigen::Translation3d(0.6, 0, 0.4));
  const auto make_table = [](planning_scene::PlanningScene& scene) {
    // A foot and the post, in one object of two primitives.
    collision_detection::World::Object table;
    table.shapes_ = {std::make_shared<shapes::Cylinder>(0.05, 0.02),
                     std::make_shared<shapes::Box>(0.05, 0.05, 0.8)};
    table.global_shape_poses_ = {Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.01)),
                                 Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.4))};
    scene.world->objects["table"] =
        std::make_shared<const collision_detection::World::Object>(std::move(table));
    scene.world->objects.erase("post");
    moveit::core::AttachedBody tool;  // of two shapes as well
    tool.name = "tool";
    tool.link = scene.getRobotModel()->getLinkModel("hand");
    for (const double z_m : {0.12, 0.16}) {
      tool.shapes.push_back(std::make_shared<shapes::Sphere>(0.01));
      tool.T_link_shapes.push_back(Eigen::Isometry3d(Eigen::Translation3d(0, 0, z_m)));
    }
    tool.touch_links = {"panda_link7"};
    scene.state.attached.push_back(tool);
  };
  const auto box = std::make_shared<shapes::Box>(0.05, 0.05, 0.8);
  auto answer = plan_past(*planner, box, T, make_table);
  EXPECT_TRUE(is_past_the_post(answer));
  // Both of its shapes may touch what the object may touch.
  answer = plan_past(*planner, box, T, [&](planning_scene::PlanningScene& scene) {
    make_table(scene);
    for (const std::string& link : model_->links_with_geometry)
      scene.matrix.entries[std::minmax<std::string>("table", link)] =
          collision_detection::AllowedCollision::ALWAYS;
    scene.matrix.entries[{"table", "tool"}] = collision_detection::AllowedCollision::ALWAYS;
  });
  ASSERT_NE(trajectory_of(answer), nullptr);
  EXPECT_FALSE(is_past_the_post(answer));
  const auto pending = directory_ / "outbox/pending";
  EXPECT_TRUE(comes_true([&] {
    return std::filesystem::is_directory(pending) && !std::filesystem::is_empty(pending);
  }));
}

TEST_F(KINSHIP_FIXTURE, AnOrientationIsKeptAlongThePathAndOtherConstraintsAreRefusedByName) {
  const auto planner = this->planner(node());
  const KeptOrientation upright = keep_orientation(*planner, -0.7, {0.2, 0.2, 3.2});
  auto answer = solve(*planner, upright.scene, upright.asked);
  ASSERT_TRUE(is_past_the_post(answer));
  const auto tilt = [&](std::size_t i) {
    return std::acos(std::min(
        1.0,
        trajectory_of(answer)->getWayPoint(i).getGlobalLinkTransform("hand").linear().col(2).dot(
            upright.R_world_kept.col(2))));
  };
  for (std::size_t i = 0; i < trajectory_of(answer)->getWayPointCount(); ++i)
    EXPECT_LT(tilt(i), 0.2) << i;

  const auto refusal = [&](const MotionPlanRequest& asked) {
    testing::internal::CaptureStderr();
    auto refused = solve(*planner, upright.scene, asked);
    EXPECT_EQ(trajectory_of(refused), nullptr);
    return testing::internal::GetCapturedStderr();
  };
  MotionPlanRequest tilted = upright.asked;
  tilted.path_constraints.orientation_constraints.front().absolute_y_axis_tolerance = 3.2;
  EXPECT_NE(refusal(tilted).find("bound no tilt"), std::string::npos);
  MotionPlanRequest elbow = upright.asked;
  elbow.path_constraints.orientation_constraints.front().link_name = "panda_link4";
  EXPECT_NE(refusal(elbow).find("does not move with 'panda_link8'"), std::string::npos);
  MotionPlanRequest joints = request(turned(0.7));
  joints.path_constraints.joint_constraints.emplace_back();
  EXPECT_NE(refusal(joints).find("a path constraint on joints"), std::string::npos);
}

TEST_F(KINSHIP_FIXTURE, AnOrientationIsKeptWithinThreeTolerances) {
  const auto planner = this->planner(node());
  // The base turns by 0.7 rad to either side.
  const KeptOrientation middle = keep_orientation(*planner, 0, {0.3, 0.3, 1.4});
  auto answer = solve(*planner, middle.scene, middle.asked);
  ASSERT_TRUE(is_past_the_post(answer));
  for (std::size_t i = 0; i < trajectory_of(answer)->getWayPointCount(); ++i) {
    const Eigen::Matrix3d R =
        middle.R_world_kept.transpose() *
        trajectory_of(answer)->getWayPoint(i).getGlobalLinkTransform("hand").linear();
    EXPECT_LE(std::abs(std::atan2(-R(1, 2), R(2, 2))), 0.3) << i;
    EXPECT_LE(std::abs(std::asin(R(0, 2))), 0.3) << i;
    EXPECT_LE(std::abs(std::atan2(-R(0, 1), R(0, 0))), 1.4) << i;
  }
}

TEST_F(KINSHIP_FIXTURE, WhatTheSceneRefusesIsNoAnswer) {
  const auto planner = this->planner(node());
  auto answer = plan_past(*planner, std::make_shared<shapes::Box>(0.05, 0.05, 0.8),
                          Eigen::Isometry3d(Eigen::Translation3d(0.6, 0, 0.4)),
                          [](planning_scene::PlanningScene& scene) {
                            scene.is_valid = [](const auto& state) { return state.q[0] < 0; };
                          });
  EXPECT_EQ(error_code_of(answer), moveit_msgs::msg::MoveItErrorCodes::INVALID_MOTION_PLAN);
  EXPECT_EQ(trajectory_of(answer), nullptr);
}

TEST_F(KINSHIP_FIXTURE, AMissingServerIsNotWaitedForAndSaidOnce) {
  testing::internal::CaptureStderr();
  constexpr int kQueries = 5;
  double longest_s = 0;
  {
    auto quiet = node();
    quiet->set("kinship.timeout_ms", 300);
    Pipeline pipeline(*this, quiet);
    const auto scene = empty_scene(turned(-0.7));
    const auto has_report = [&] {
      const auto pending = directory_ / "outbox/pending";
      return std::filesystem::is_directory(pending) && !std::filesystem::is_empty(pending);
    };
    // Until the robot is read there is nothing to report.
    EXPECT_TRUE(comes_true([&] {
      pipeline.plan(scene, request(turned(0.7)));
      return has_report();
    }));
    for (int i = 0; i < kQueries; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      auto answer = pipeline.plan(scene, request(turned(0.7)));
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
      longest_s = std::max(longest_s, took.count());
      ASSERT_NE(trajectory_of(answer), nullptr);
      EXPECT_EQ(trajectory_of(answer)->getWayPointCount(), 2U);  // the other planner's
    }
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_LT(longest_s, 0.5);
  EXPECT_NE(said.find("no server of Kinship answers"), std::string::npos) << said;
  std::istringstream lines(said);
  std::set<std::string> told;
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(told.insert(line).second) << "said again: " << line;

  // A server that comes up gets the reports, which waited on disk.
  const test::ServerProcess server({.store = directory_ / "fleet.db", .domain = domain_.number()});
  const std::string outbox = (directory_ / "outbox").string();
  kinship_client_options options{};
  options.size = sizeof options;
  options.domain = domain_.number();
  options.outbox = outbox.c_str();
  kinship_client* client = nullptr;
  ASSERT_EQ(kinship_client_open(&options, &client), KINSHIP_OK) << kinship_error_text();
  kinship_outbox state{};
  state.size = sizeof state;
  EXPECT_EQ(kinship_flush(client, 60'000, &state), KINSHIP_OK) << kinship_error_text();
  EXPECT_GT(state.accepted, static_cast<std::size_t>(kQueries));
  EXPECT_EQ(state.refused, 0U);
  kinship_client_close(client);
}

}  // namespace
}  // namespace kinship::kinship_moveit_test
