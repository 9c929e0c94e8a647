#include <string>
#include <utility>

#include "client/experiments/studies/furniture_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {
namespace {

constexpr double kFurnitureStep_rad = 0.05;  // a bar is 16 mm thick
constexpr std::uint64_t kFurnitureMaxChecks = 200'000;
constexpr int kFurnitureGoals = 10;

/// Where a robot stands before the furniture, turned like the task frame.
Eigen::Isometry3d before_furniture(double height_m, double back_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(-back_m, 0, height_m));
}

Study furniture_study(FurnitureKind kind, std::string purpose) {
  Study study;
  study.name = study_name(kind);
  study.family = "furniture";
  study.purpose = std::move(purpose);
  study.robots = cobots_at_home();
  study.settings.resolution = kFurnitureStep_rad;
  study.settings.overshoot = 1;
  study.settings.max_checks = kFurnitureMaxChecks;
  study.settings.max_goals = kFurnitureGoals;
  study.learning_instances = 50;
  study.test_instances = 50;
  study.make_instances = [kind](const models::LoadedRobot& robot, const StudyRobot& placed) {
    return make_furniture_instances(kind, kFurnitureGoals, robot, placed);
  };
  return study;
}

}  // namespace

std::vector<StudyRobot> cobots_at_home() {
  return {{.model = "sara_like",
           .T_task_base = before_furniture(0.35, 0.1),
           .start = Eigen::VectorXd{{0, -0.3, 0, -1.9, 0, 1.2, 0}}},
          {.model = "iiwa14",
           .T_task_base = before_furniture(0.35, 0.1),
           .start = Eigen::VectorXd{{0, -0.3, 0, -1.9, 0, 1.2, 0}}},
          {.model = "ur10e",
           .T_task_base = before_furniture(0.5, 0.2),
           .start = Eigen::VectorXd{{0, -2.2, 2.2, -1.57, -1.57, 0}}},
          {.model = "panda",
           .T_task_base = before_furniture(0.35, 0.1),
           .start = Eigen::VectorXd{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}}},
          {.model = "sawyer",
           .T_task_base = before_furniture(0.4, 0.1),
           .start = Eigen::VectorXd{{0, -1.18, 0, 2.18, 0, 0.57, 3.3161}}}};
}

std::vector<Study> furniture_studies() {
  return {
      furniture_study(FurnitureKind::Shelf, "five cobots reach into a shelf of two boards"),
      furniture_study(FurnitureKind::TallShelf, "five cobots reach into a shelf of four boards"),
      furniture_study(FurnitureKind::Box, "five cobots reach into a box with a half open lid"),
      furniture_study(FurnitureKind::Cage, "five cobots reach through the bars of a cage"),
      furniture_study(FurnitureKind::Table, "five cobots reach onto a table and below it")};
}

}  // namespace kinship::experiments
