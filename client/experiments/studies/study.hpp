#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "client/guided/plan_settings.hpp"
#include "proto/types/problem.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::experiments {

/// What instances are for. No instance is in two of these: each has seeds of its own.
enum class InstanceSet { Calibration, Learning, Tuning, Test, Order };

/// "calibration", "learning", "tuning", "test" or "order". \throws Failure(InvalidInput) for
/// another word.
InstanceSet parse_instance_set(std::string_view name);

/// A robot of a study and where it stands.
struct StudyRobot {
  std::string model;  ///< its folder below robots/models, and its label
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  /// Where its instances start, but for noise, joint units. A constant of a frozen study, so that
  /// it does not depend on the inverse kinematics of the day; empty: searched.
  Eigen::VectorXd start{};
};

/// The instances of a study for one robot: equal arguments, equal problems.
using DrawInstance = std::function<Problem(std::uint64_t seed, std::uint32_t index)>;

/// A task that several robots have learned and are tested on. Frozen once calibrated with uniform
/// sampling: scenes, placements, seeds and numbers of instances are constants of the code.
struct Study {
  std::string name;      ///< also its task at the server, and its folder of results
  std::string purpose;   ///< for the command line's help
  std::string family{};  ///< name that stands for it and others like it; may be empty
  std::vector<StudyRobot> robots;
  /// Of every query; the overshoot may be chosen on tuning instances. By steps, so that a check
  /// means the same to all planners.
  guided::PlanSettings settings = {.clearance_m = 0};
  double guided_share = 1;      ///< of samples in guided queries; chosen on tuning instances
  bool is_constrained = false;  ///< its problems keep to a task space region
  std::uint32_t learning_instances = 0;
  std::uint32_t test_instances = 0;

  /// What instances look like for one robot.
  /// \throws Failure(NotFound) if the robot cannot do the task where it stands.
  std::function<DrawInstance(const models::LoadedRobot&, const StudyRobot&)> make_instances;
};

/// The seed of the instances of a set. Learning instances differ between robots, as those of a
/// fleet do; all robots are tuned and tested on the same ones.
/// \param robot  index into Study::robots.
std::uint64_t seed_of(InstanceSet set, std::size_t robot);

/// The studies with planar arms: `planar` (the paper's first experiment), `planar_p1` and
/// `open_table`.
std::vector<Study> planar_studies();

/// The studies with collaborative robots: `cobots` (the paper's second experiment) and
/// `open_table_cobots`.
std::vector<Study> cobot_studies();

/// The family `furniture`: five cobots take something from furniture that stands elsewhere each
/// time, a study for each kind of furniture.
std::vector<Study> furniture_studies();

/// `kitting`: five cobots put parts from a worktable into the ten compartments of a rack.
std::vector<Study> kitting_studies();

/// The family `dear`: tasks whose uniform planning takes long, a study for each kind.
std::vector<Study> dear_studies();

/// Every study, by name.
const std::vector<Study>& studies();

/// \throws Failure(NotFound) that names the studies there are.
const Study& find_study(std::string_view name);

/// The names of families, each once.
std::vector<std::string> families();

/// The studies of a family in their order, or the one study of that name.
/// \throws Failure(NotFound) that names the studies there are.
std::vector<const Study*> find_studies(std::string_view name);

}  // namespace kinship::experiments
