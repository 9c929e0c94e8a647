#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <thread>
#include <vector>

#if __has_include(<moveit/planning_interface/planning_response_adapter.hpp>)
#include <moveit/planning_interface/planning_interface.hpp>
#else
#include <moveit/planning_interface/planning_interface.h>
#endif

#include "client/c/kinship.h"
#include "proto/types/pose.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::kinship_moveit_test {

using planning_interface::MotionPlanRequest;
using planning_interface::MotionPlanResponse;
using recall::PosedQuery;
using recall::test_support::ShelfCell;

constexpr Eigen::Index kDof = 7;

#ifdef KINSHIP_STUB_HUMBLE
inline auto& trajectory_of(MotionPlanResponse& response) { return response.trajectory_; }
inline int error_code_of(MotionPlanResponse& response) { return response.error_code_.val; }
#else
inline auto& trajectory_of(MotionPlanResponse& response) { return response.trajectory; }
inline int error_code_of(MotionPlanResponse& response) { return response.error_code.val; }
#endif

/// The plugin's library, and another planner's, in an ament index.
class InstalledPlugins {
 public:
  InstalledPlugins() {
    install("kinship_moveit", KINSHIP_PLUGIN,
            test::source_dir() + "/client/ros2/kinship_moveit/kinship_moveit_plugins.xml");
    const auto other = directory_ / "other.xml";
    std::ofstream(other) << "<library path=\"kinship_moveit_other\"><class name=\"other/Straight\" "
                            "type=\"kinship_moveit_test::StraightPlanner\" "
                            "base_class_type=\"planning_interface::PlannerManager\"/></library>";
    install("kinship_moveit_other", KINSHIP_OTHER_PLUGIN, other);
  }
  std::filesystem::path prefix() const { return directory_ / "prefix"; }

 private:
  /// As ament installs a package with plugins.
  void install(const std::string& package, const std::filesystem::path& library,
               const std::filesystem::path& description) {
    namespace fs = std::filesystem;
    const fs::path prefix = this->prefix();
    const fs::path index = prefix / "share/ament_index/resource_index";
    for (const fs::path& folder :
         {index / "packages", index / "moveit_core__pluginlib__plugin", prefix / "lib",
          prefix / "share" / package, prefix / "share/moveit_core"})
      fs::create_directories(folder);
    std::ofstream(index / "packages" / package) << std::flush;
    std::ofstream(index / "packages/moveit_core") << std::flush;
    for (const std::string& name : {package, std::string("moveit_core")})
      std::ofstream(prefix / "share" / name / "package.xml")
          << "<package format=\"3\"><name>" << name << "</name></package>";
    fs::copy_file(description, prefix / "share" / package / "plugins.xml");
    std::ofstream(index / "moveit_core__pluginlib__plugin" / package)
        << "share/" << package << "/plugins.xml\n";
    fs::create_symlink(library, prefix / "lib" / ("lib" + package + ".so"));
  }

  const test::TemporaryDirectory directory_;
};

/// A Panda as MoveIt has it, and its shelf.
class PluginCell : public testing::Test {
 protected:
  PluginCell() {
    static const InstalledPlugins kInstalled;  // class_loader knows libraries by their path
    setenv("AMENT_PREFIX_PATH", kInstalled.prefix().c_str(), 1);
    make_model();
  }

 public:
  template <typename Base>
  std::shared_ptr<Base> load(const std::string& base, const std::string& name) {
    auto loader = std::make_shared<pluginlib::ClassLoader<Base>>("moveit_core", base);
    auto made = loader->createSharedInstance(name);
    return {made.get(), [loader, made](Base*) mutable { made.reset(); }};
  }

 protected:
  std::shared_ptr<planning_interface::PlannerManager> planner(const rclcpp::Node::SharedPtr& node) {
    auto made = load<planning_interface::PlannerManager>("planning_interface::PlannerManager",
                                                         "kinship_moveit/PlannerManager");
    EXPECT_TRUE(made->initialize(model_, node, "kinship"));
    return made;
  }

  rclcpp::Node::SharedPtr node() const {
    auto node = std::make_shared<rclcpp::Node>();
    node->set("kinship.task", std::string("reach"));
    node->set("kinship.robot", test::source_dir() + "/robots/models/panda");
    node->set("kinship.transfer",
              std::vector<double>{0, 0, 0.06, 0, 0, -0.3826834323650898, 0.9238795325112867});
    node->set("kinship.domain", static_cast<int>(domain_.number()));
    node->set("kinship.outbox", (directory_ / "outbox").string());
    node->set("kinship.groups", std::vector<std::string>{"panda_arm"});
    node->set("kinship.control_fraction", 0.0);
    return node;
  }

  /// A scene of the shelf, checked by Kinship's own world.
  std::shared_ptr<planning_scene::PlanningScene> scene(const PosedQuery& posed) const {
    auto made = empty_scene(posed.start);
    for (const SceneObject& object : posed.surroundings.scene.objects) {
      const Eigen::Vector3d size = std::get<BoxShape>(object.shape).size;
      add(*made, object.name, std::make_shared<shapes::Box>(size.x(), size.y(), size.z()),
          object.T_task_object);
    }
    auto world = std::make_shared<collision::CollisionWorld>(cell_.solids, posed.surroundings);
    made->is_valid = [world](const moveit::core::RobotState& state) {
      return !world->collides(state.q);
    };
    return made;
  }
  std::shared_ptr<planning_scene::PlanningScene> empty_scene(const Eigen::VectorXd& start) const {
    moveit::core::RobotState state(model_, kDof);
    state.q = start;
    auto made = std::make_shared<planning_scene::PlanningScene>(model_, state);
    made->is_valid = [](const moveit::core::RobotState&) { return true; };
    return made;
  }
  static void add(planning_scene::PlanningScene& scene, const std::string& name,
                  shapes::ShapeConstPtr shape, const Eigen::Isometry3d& T) {
    collision_detection::World::Object object;
    object.shapes_.push_back(std::move(shape));
    object.global_shape_poses_.push_back(T);
    scene.world->objects[name] =
        std::make_shared<const collision_detection::World::Object>(std::move(object));
  }

  /// To all of the configurations, any of which will do.
  MotionPlanRequest request(const Eigen::MatrixXd& goals) const {
    MotionPlanRequest asked;
    asked.group_name = "panda_arm";
    asked.allowed_planning_time = 10;
    for (const auto& goal : goals.colwise()) {
      moveit_msgs::msg::Constraints constraints;
      for (Eigen::Index i = 0; i < kDof; ++i)
        constraints.joint_constraints.push_back(
            {variables()[static_cast<std::size_t>(i)], goal[i], 1e-3, 1e-3});
      asked.goal_constraints.push_back(constraints);
    }
    return asked;
  }

  const std::vector<std::string>& variables() const {
    return model_->getJointModelGroup("panda_arm")->variables;
  }

  /// There is no event for what happens behind planning.
  static bool comes_true(const std::function<bool()>& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end)
        return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return true;
  }
  /// Plans as soon as the robot has been read.
  static MotionPlanResponse solve(planning_interface::PlannerManager& planner,
                                  const planning_scene::PlanningSceneConstPtr& scene,
                                  const MotionPlanRequest& asked) {
    moveit_msgs::msg::MoveItErrorCodes code;
    MotionPlanResponse response;
    const auto context = planner.getPlanningContext(scene, asked, code);
    if (context != nullptr)
      context->solve(response);
    return response;
  }

  /// A client of the test's own, which knows the robot.
  kinship_client* client(bool registers = true) {
    const std::string outbox = (directory_ / "tests_outbox").string();
    kinship_client_options options{};
    options.size = sizeof options;
    options.domain = domain_.number();
    options.outbox = outbox.c_str();
    options.timeout_ms = 120'000;
    kinship_client* made = nullptr;
    EXPECT_EQ(kinship_client_open(&options, &made), KINSHIP_OK) << kinship_error_text();
    if (!registers)
      return made;
    const std::string folder = test::source_dir() + "/robots/models/panda";
    kinship_robot_file file{};
    file.size = sizeof file;
    file.source = folder.c_str();
    EXPECT_EQ(kinship_register_file(made, &file, &robot_, nullptr), KINSHIP_OK)
        << kinship_error_text();
    return made;
  }

  const ShelfCell cell_;
  const test::TemporaryDirectory directory_;
  const test::ReservedDomain domain_;
  std::shared_ptr<moveit::core::RobotModel> model_;
  kinship_robot robot_{};  // of client()

 private:
  void make_model() {
    model_ = std::make_shared<moveit::core::RobotModel>();
    model_->name = "panda";
    const auto link = [&](const std::string& name, const moveit::core::LinkModel* parent) {
      return &model_->link_models.try_emplace(name, name, parent).first->second;
    };
    const auto* base = link("panda_link0", nullptr);
    link("panda_link4", nullptr);
    const auto* wrist = link("panda_link7", nullptr);
    link("panda_link8", wrist);
    link("hand", wrist);
    for (int i = 0; i < 8; ++i)
      model_->links_with_geometry.push_back("panda_link" + std::to_string(i));
    joint_ = std::make_unique<moveit::core::JointModel>(base);
    moveit::core::JointModelGroup& group = model_->groups["panda_arm"];
    group.name = "panda_arm";
    group.links = {"panda_link1", "panda_link7", "panda_link8"};
    group.joints = {joint_.get()};
    for (Eigen::Index i = 0; i < kDof; ++i) {
      group.variables.push_back("panda_joint" + std::to_string(i + 1));
      model_->bounds[group.variables.back()] = {cell_.chain.lower()[i], cell_.chain.upper()[i]};
    }
    model_->kinematics = [this](const std::string& name, const Eigen::VectorXd& q) {
      if (name == "panda_link0" || name == "panda_link4")
        return Eigen::Isometry3d::Identity();
      return Eigen::Isometry3d(kinematics::T_base_transfer(cell_.chain, q) *
                               cell_.chain.T_tip_transfer().inverse());
    };
  }

  std::unique_ptr<moveit::core::JointModel> joint_;
};

}  // namespace kinship::kinship_moveit_test
