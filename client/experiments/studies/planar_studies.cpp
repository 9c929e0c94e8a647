#include <utility>

#include "client/experiments/studies/planar_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {
namespace {

constexpr double kPlanarStep_rad = 0.05;
constexpr std::uint64_t kPlanarMaxChecks = 200'000;

/// Where an arm stands: its base turned like the task frame.
Eigen::Isometry3d at(double x, double y) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, 0));
}

/// The three arms of the paper, at the origin of the task frame.
std::vector<StudyRobot> planar_arms() {
  return {{.model = "planar_5r_a"}, {.model = "planar_5r_b"}, {.model = "planar_7r_c"}};
}

/// The same, each where the slot is as hard for it as the paper says, or nearly; starting in the
/// free posture that is nearest to the stretched arm.
std::vector<StudyRobot> placed_arms() {
  std::vector<StudyRobot> arms = planar_arms();
  arms[1].T_task_base = at(-0.05, 0);
  arms[2].T_task_base = at(0.03, 0.06);
  arms[0].start = Eigen::VectorXd{{0.1398, 1.3506, 0.7718, -0.2780, -0.6841}};
  arms[1].start = Eigen::VectorXd{{-0.1597, 1.1254, 1.1073, -0.0281, -0.7450}};
  arms[2].start = Eigen::VectorXd{{-0.0384, 0.7116, 1.7609, -0.4463, -0.3425, 0.4753, -0.8206}};
  return arms;
}

Study planar_study(PlanarLayout layout, std::string purpose, std::vector<StudyRobot> robots,
                   int max_goals) {
  Study study;
  study.name = layout.name;
  study.purpose = std::move(purpose);
  study.robots = std::move(robots);
  study.settings.resolution = kPlanarStep_rad;
  study.settings.overshoot = 1;
  study.settings.max_checks = kPlanarMaxChecks;
  study.settings.max_goals = max_goals;
  study.learning_instances = 200;
  study.test_instances = 50;
  study.make_instances = [layout = std::move(layout)](const models::LoadedRobot& robot,
                                                      const StudyRobot& placed) {
    return make_planar_instances(layout, robot, placed);
  };
  return study;
}

/// The carried box comes from a place beyond a slanted box and goes into a slot between two others.
PlanarLayout slot(std::string name, double half_gap_m, double spare_m) {
  return {.name = std::move(name),
          .boxes = {{{0.62, half_gap_m, 0}, 0.2, 0.04},
                    {{0.62, -half_gap_m, 0}, 0.2, 0.04},
                    {{0.30, 0.42, -0.6}, 0.12, 0.05}},
          .start = {0.12, 0.72, 1.3},
          .goal = {0.62, 0, 0},
          .spare_m = spare_m};
}

/// Two wide compartments one above the other: next to nothing is in the way.
PlanarLayout open_table() {
  return {.name = "open_table",
          .boxes = {{{0.7, 0, 0}, 0.2, 0.03},
                    {{0.7, 0.46, 0}, 0.2, 0.03},
                    {{0.7, -0.46, 0}, 0.2, 0.03}},
          .start = {0.65, 0.23, 0},
          .goal = {0.65, -0.23, 0}};
}

}  // namespace

std::vector<Study> planar_studies() {
  constexpr int kAllGoals = 20;
  constexpr int kFewGoals = 8;
  std::vector<Study> studies;
  studies.push_back(planar_study(slot("planar", 0.105, 0.01),
                                 "the paper's first experiment: three planar arms", placed_arms(),
                                 kAllGoals));
  studies.push_back(planar_study(slot("planar_p1", 0.105, 0),
                                 "the scene of the first measurements, not calibrated",
                                 planar_arms(), kFewGoals));
  studies.push_back(planar_study(open_table(), "three planar arms with next to nothing in the way",
                                 planar_arms(), kAllGoals));
  return studies;
}

}  // namespace kinship::experiments
