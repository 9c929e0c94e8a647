#include "client/experiments/studies/kitting_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {
namespace {

constexpr double kKittingStep_rad = 0.05;
constexpr std::uint64_t kKittingMaxChecks = 200'000;
constexpr int kKittingGoals = 10;

/// Where a robot stands: at the edge of the worktable, turned like the task frame.
Eigen::Isometry3d at_worktable(double height_m, double back_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(-back_m, 0, height_m));
}

/// Where the rack is about as hard for each as for the others; starting over the middle of the
/// parts in the free posture that is nearest to the middle of the robot's limits.
std::vector<StudyRobot> cobots_at_worktable() {
  return {{.model = "sara_like",
           .T_task_base = at_worktable(0.3, 0.32),
           .start = Eigen::VectorXd{{-0.0102, 1.1444, 0.0156, -1.4522, -0.0275, 0.5453, 0.0197}}},
          {.model = "iiwa14",
           .T_task_base = at_worktable(0.2, 0.1),
           .start = Eigen::VectorXd{{0.0048, 1.1010, -0.0065, -1.6140, 0.0140, 0.4266, -0.0109}}},
          {.model = "ur10e",
           .T_task_base = at_worktable(0.3, 0.2),
           .start = Eigen::VectorXd{{-0.2756, 1.2633, -2.2597, -0.5744, -1.5708, 1.2952}}},
          {.model = "panda",
           .T_task_base = at_worktable(0.2, 0.1),
           .start = Eigen::VectorXd{{-0.4382, 0.7850, 0.3533, -2.1035, -0.7312, 2.7667, -1.8436}}},
          {.model = "sawyer",
           .T_task_base = at_worktable(0.15, 0.1),
           .start = Eigen::VectorXd{{-0.2159, -0.7960, -0.1115, 1.9973, 0.2113, 0.3802, 1.2531}}}};
}

}  // namespace

std::vector<Study> kitting_studies() {
  Study study;
  study.name = "kitting";
  study.purpose = "five cobots put parts into the ten compartments of a rack";
  study.robots = cobots_at_worktable();
  study.settings.resolution = kKittingStep_rad;
  study.settings.overshoot = 1;
  study.settings.max_checks = kKittingMaxChecks;
  study.settings.max_goals = kKittingGoals;
  study.learning_instances = 50;
  study.test_instances = 50;
  study.make_instances = [](const models::LoadedRobot& robot, const StudyRobot& placed) {
    return make_kitting_instances(kKittingGoals, robot, placed);
  };
  return {study};
}

}  // namespace kinship::experiments
