#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/not_planned.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/scene.hpp"
#include "proto/types/task_space_region.hpp"

namespace kinship {

/// One planning problem for kinship-plan (a line of a problem file).
struct Problem {
  std::string name;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< missing: used as identity, reported as missing
  Eigen::VectorXd start;                         ///< dof, joint units; empty if a pose is given
  std::optional<Eigen::Isometry3d> T_task_start;  ///< of the transfer frame
  Eigen::MatrixXd goal_configurations;            ///< dof x n; empty if a pose is given
  std::optional<Eigen::Isometry3d> T_task_goal;   ///< of the transfer frame
  Scene scene;
  std::vector<AttachedObject> attached;
  std::vector<std::pair<std::string, std::string>> allowed_collisions;
  std::optional<TaskSpaceRegion> constraint;  ///< in the task frame, of the transfer frame
  double time_limit_s = 10;
  std::uint64_t seed = 0;
};

/// Result of kinship-plan for a problem, in input order.
struct ProblemResult {
  std::string name;
  bool solved = false;
  std::uint64_t collision_checks = 0;  ///< of planning
  std::uint64_t goal_checks = 0;  ///< of configurations of a start or goal pose, before planning
  std::uint64_t shortcut_checks = 0;  ///< of shortening the path, after planning
  std::uint64_t projections = 0;
  bool proven = false;  ///< solved, and proven free of collision between the waypoints too
  /// Edges that were free at the tested configurations but collide in between: planned again.
  std::uint64_t refuted_edges = 0;
  double planning_time_s = 0;  ///< without goal configurations and shortcutting
  /// CPU time of the thread for all of it: start, goals, guidance, search, shortening, proof.
  double processor_time_s = 0;
  double time_limit_s = 0;
  std::optional<Eigen::VectorXd> start = {};   ///< dof: where planning began; missing: it did not
  std::optional<NotPlanned> not_planned = {};  ///< why no search was begun; missing: a search was
  std::optional<Eigen::MatrixXd> waypoints;    ///< dof x n
  std::optional<double> path_length = {};      ///< joint units; like the next two, of `waypoints`
  std::optional<double> hand_length_m = {};    ///< of the way of the transfer frame
  /// Of what moves from the obstacles, where the path is looked at; 0.1 if nothing is nearer.
  std::optional<double> least_clearance_m = {};
  std::optional<Digest> distribution_id;  ///< present if there was guidance, used or not
  std::uint64_t distribution_revision = 0;
  SamplingMode sampling_mode =
      SamplingMode::Uniform;              ///< with guidance: Guided, Control, or Uniform on request
  double share = 0;                       ///< of guided samples; 0 unless Guided
  Guide guide = Guide::None;              ///< of a guided query
  double track_share = 0;                 ///< of samples around tracks; a part of share
  std::uint64_t experience_revision = 0;  ///< of the stored pose paths behind the tracks; 0: none
  std::uint64_t tracks_followed = 0;
  std::uint64_t recall_tries = 0;  ///< whole stored paths tried before a search
  /// Guided, but with fewer samples of the mixture than wanted, or none: start or goals are far
  /// from the mixture.
  bool gate_fired = false;
  FoundBy found_by = FoundBy::Nothing;
  std::string reason;                ///< why not solved
  std::string planner = {};          ///< empty if none was started
  std::string guidance_reason = {};  ///< why not guided; empty if guided
};

}  // namespace kinship
