#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// Relation of a source robot to the target.
enum class Relation {
  Other,      ///< another arm: by inverse kinematics
  SameArm,    ///< the same arm within tolerance: waypoints taken over and polished
  Identical,  ///< the same kinematics, or the robot itself: waypoints taken over unchanged
};

/// Outcomes of a transfer: poses after resampling, by outcome. Every pose is counted once: poses =
/// poses_solved + out_of_reach + outside_limits + not_converged + colliding.
struct TransferCounts {
  std::uint64_t poses = 0;         ///< after resampling
  std::uint64_t poses_solved = 0;  ///< with at least one configuration of the target
  std::uint64_t out_of_reach = 0;  ///< poses without a solution, by reason
  std::uint64_t outside_limits = 0;
  std::uint64_t not_converged = 0;
  std::uint64_t colliding = 0;       ///< poses of which filters left out every configuration
  std::uint64_t configurations = 0;  ///< from the poses
  /// Of `configurations`: found for one pose alone, neither along a track nor taken over.
  std::uint64_t random_configurations = 0;
  std::uint64_t tracks_tried = 0;  ///< along the paths
  std::uint64_t tracks_kept = 0;   ///< that cover enough of their path
  /// Of `tracks_tried`: those that cover the whole path. Shows the share of the target's solutions
  /// that continue through the paths.
  std::uint64_t tracks_through = 0;
  std::uint64_t filter_checks = 0;     ///< configurations that the filters checked
  std::uint64_t self_collisions = 0;   ///< of these, left out: the target touches itself
  std::uint64_t scene_collisions = 0;  ///< of these, left out: it touches the recorded scene
  /// Of `poses_solved`: on a kept track. The others have random configurations, or were taken over.
  std::uint64_t poses_on_tracks = 0;

  TransferCounts& operator+=(const TransferCounts& other);
};

/// Contribution of one source robot to a distribution.
struct Source : TransferCounts {
  Digest robot;
  std::string label;
  std::uint64_t paths = 0;       ///< of (robot, task) when the fit read it
  std::uint64_t generation = 0;  ///< of (robot, task) when the fit read it
  Relation relation = Relation::Other;
  std::uint64_t paths_used = 0;  ///< read and transferred; fewer than `paths` with `since` or a cap
  double mass = 0;               ///< its share of the weight of all configurations, 0 to 1
  std::uint64_t paths_with_scene = 0;  ///< of `paths_used`: filtered by their recorded scene
};

template <>
inline constexpr std::tuple kFieldsOf<Source>{
    Field{"robot", &Source::robot},
    Field{"label", &Source::label, {.limit = kMaxLabelBytes}},
    Field{"paths", &Source::paths},
    Field{"generation", &Source::generation},
    Field{"poses", &Source::poses},
    Field{"poses_solved", &Source::poses_solved},
    Field{"relation", &Source::relation},
    Field{"paths_used", &Source::paths_used},
    Field{"out_of_reach", &Source::out_of_reach},
    Field{"outside_limits", &Source::outside_limits},
    Field{"not_converged", &Source::not_converged},
    Field{"configurations", &Source::configurations},
    Field{"mass", &Source::mass, {.min = 0, .max = 1}},
    Field{"colliding", &Source::colliding},
    Field{"tracks_tried", &Source::tracks_tried},
    Field{"tracks_kept", &Source::tracks_kept},
    Field{"random_configurations", &Source::random_configurations},
    Field{"filter_checks", &Source::filter_checks},
    Field{"self_collisions", &Source::self_collisions},
    Field{"scene_collisions", &Source::scene_collisions},
    Field{"paths_with_scene", &Source::paths_with_scene},
    Field{"tracks_through", &Source::tracks_through},
    Field{"poses_on_tracks", &Source::poses_on_tracks}};

inline TransferCounts& TransferCounts::operator+=(const TransferCounts& other) {
  for_each_field<Source>([&]<typename Type, typename Value>(const Field<Value, Type>& field) {
    if constexpr (std::is_same_v<Value, TransferCounts>)
      this->*field.member += other.*field.member;
  });
  return *this;
}

}  // namespace kinship
