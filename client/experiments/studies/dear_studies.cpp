#include <string>
#include <utility>

#include "client/experiments/studies/dear_scene.hpp"
#include "client/experiments/studies/furniture_scene.hpp"
#include "client/experiments/studies/study.hpp"

/// Measures, placements, robots and steps of the kinds are chosen by uniform planning on tuning
/// instances alone, so that for each robot its mean is 20 000 checks or 20 ms at least, and are
/// frozen since 2026-11-28: guided results never change them.
namespace kinship::experiments {
namespace {

// Joint units: rad, m of a lift. A tool moves further than a hand.
constexpr double kDearStep = 0.05, kToolStep = 0.02;
constexpr std::uint64_t kDearMaxChecks = 1'000'000, kUprightMaxChecks = 300'000;
constexpr int kDearGoals = 10;

/// Arms that stand before the furniture, by their homes there.
std::vector<StudyRobot> arms_at_home(const std::vector<std::string>& models) {
  std::vector<StudyRobot> chosen;
  for (const StudyRobot& placed : cobots_at_home())
    for (const std::string& model : models)
      if (placed.model == model)
        chosen.push_back(placed);
  return chosen;
}

/// Arms on lifts: on the floor, the lift half up.
std::vector<StudyRobot> lifts_at_home() {
  const Eigen::Isometry3d T_task_base(Eigen::Translation3d(-0.1, 0, 0));
  return {{.model = "panda_lift",
           .T_task_base = T_task_base,
           .start = Eigen::VectorXd{{0.3, 0, -0.785, 0, -2.356, 0, 1.571, 0.785}}},
          {.model = "iiwa14_lift",
           .T_task_base = T_task_base,
           .start = Eigen::VectorXd{{0.3, 0, -0.3, 0, -1.9, 0, 1.2, 0}}}};
}

Study dear_study(DearKind kind, std::vector<StudyRobot> robots, std::string purpose) {
  Study study;
  study.name = study_name(kind);
  study.family = "dear";
  study.purpose = std::move(purpose);
  study.robots = std::move(robots);
  const bool has_tool = kind == DearKind::Window || kind == DearKind::Gun ||
                        kind == DearKind::Bin || kind == DearKind::Upright;
  study.settings.resolution = has_tool ? kToolStep : kDearStep;
  study.settings.overshoot = 1;
  study.settings.max_checks = kind == DearKind::Upright ? kUprightMaxChecks : kDearMaxChecks;
  study.settings.max_goals = kDearGoals;
  study.is_constrained = kind == DearKind::Upright;
  study.learning_instances = 50;
  study.test_instances = 50;
  study.make_instances = [kind](const models::LoadedRobot& robot, const StudyRobot& placed) {
    return make_dear_instances(kind, kDearGoals, robot, placed);
  };
  return study;
}

}  // namespace

std::vector<Study> dear_studies() {
  const std::vector<StudyRobot> lifts = lifts_at_home();
  const std::vector<StudyRobot> reaching = arms_at_home({"iiwa14", "sara_like"});
  return {dear_study(DearKind::LiftCage, lifts, "arms on lifts reach through the bars of cages"),
          dear_study(DearKind::LiftShelf, lifts, "arms on lifts reach into compartments"),
          dear_study(DearKind::Window, reaching, "cobots bring a long tool through a deep window"),
          dear_study(DearKind::Gun, arms_at_home({"iiwa14", "sara_like", "ur10e"}),
                     "cobots bring a C-shaped gun from flange to flange of a frame"),
          dear_study(DearKind::Bin, reaching, "cobots reach from one deep bin into another"),
          dear_study(DearKind::Upright, arms_at_home({"ur10e", "sara_like"}),
                     "cobots carry a vessel upright through a window"),
          dear_study(DearKind::Cloud, reaching,
                     "cobots reach into compartments known by a point cloud"),
          dear_study(DearKind::Beside, arms_at_home({"panda", "iiwa14", "sara_like"}),
                     "cobots reach into compartments beside another arm")};
}

}  // namespace kinship::experiments
