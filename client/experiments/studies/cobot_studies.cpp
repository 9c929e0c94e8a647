#include <utility>

#include "client/experiments/studies/carrying_scene.hpp"
#include "client/experiments/studies/study.hpp"

namespace kinship::experiments {
namespace {

constexpr double kStep_rad = 0.1;
constexpr std::uint64_t kMaxChecks = 200'000;

/// Where a robot stands: on a stand at the edge of the table, turned like the task frame.
/// \param height_m  of its base above the top of the table.
/// \param back_m    from the task frame's origin away from the table.
Eigen::Isometry3d on_stand(double height_m, double back_m = 0) {
  return Eigen::Isometry3d(Eigen::Translation3d(-back_m, 0, height_m));
}

/// The higher a base, the harder it is to reach down into the bin: so each robot has the height
/// at which the task is about as hard for it as the paper says. It starts in the free posture over
/// the container that is nearest to the middle of its limits.
std::vector<StudyRobot> placed_cobots() {
  return {{.model = "sara_like",
           .T_task_base = on_stand(0.05),
           .start = Eigen::VectorXd{{0.1842, 0.7206, 0.4567, -1.9674, -0.5598, 0.5799, -2.1209}}},
          {.model = "iiwa14",
           .T_task_base = on_stand(0.1),
           .start = Eigen::VectorXd{{0.2920, 1.0971, 0.3673, -1.5105, -0.5638, 0.6409, -2.2068}}},
          {.model = "ur10e",
           .T_task_base = on_stand(0.6, 0.15),
           .start = Eigen::VectorXd{{0.1867, -0.1210, 1.3231, 0.3688, 1.5708, 1.7575}}},
          {.model = "panda",
           .T_task_base = on_stand(0.25),
           .start = Eigen::VectorXd{{0.7121, 1.0840, -0.1287, -1.7949, 0.4094, 2.8527, 1.0429}}},
          {.model = "sawyer",
           .T_task_base = on_stand(0.2),
           .start = Eigen::VectorXd{{0.1966, -0.5393, 0.1012, 1.7205, -0.2240, 0.4008, -0.9409}}}};
}

Study cobot_study(CarryingLayout layout, std::string purpose) {
  Study study;
  study.name = layout.name;
  study.purpose = std::move(purpose);
  study.robots = placed_cobots();
  study.settings.resolution = kStep_rad;
  study.settings.overshoot = 1;
  study.settings.max_checks = kMaxChecks;
  study.settings.max_goals = layout.goal_branches;
  study.is_constrained = true;
  study.learning_instances = 500;
  study.test_instances = 100;
  study.make_instances = [layout = std::move(layout)](const models::LoadedRobot& robot,
                                                      const StudyRobot& placed) {
    return make_carrying_instances(layout, robot, placed);
  };
  return study;
}

/// From the table over a post into the free half of a bin.
CarryingLayout into_the_bin() {
  return {.name = "cobots",
          .pick = {0.5, 0.3, 0},
          .place = {0.5, -0.3, 0},
          .between_places_m = 0.13,
          .bin = Bin{.length_m = 0.26, .width_m = 0.14, .height_m = 0.18, .wall_m = 0.024},
          .objects = {{"post", {0.55, 0, 0}, {0.08, 0.08, 0.7}}},
          .container = {0.11, 0.08, 0.1},
          .tilt_rad = 0.15,
          .goal_branches = 10};
}

/// The same motion over an empty table: next to nothing is in the way.
CarryingLayout over_the_table() {
  CarryingLayout layout = into_the_bin();
  layout.name = "open_table_cobots";
  layout.bin.reset();
  layout.objects.clear();
  return layout;
}

}  // namespace

std::vector<Study> cobot_studies() {
  std::vector<Study> studies;
  studies.push_back(
      cobot_study(into_the_bin(), "the paper's second experiment: five cobots carry a container"));
  studies.push_back(cobot_study(over_the_table(), "five cobots carry over an empty table"));
  return studies;
}

}  // namespace kinship::experiments
