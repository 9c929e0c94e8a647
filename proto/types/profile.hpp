#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>

#include "proto/types/field.hpp"
#include "proto/types/selection.hpp"

namespace kinship {

/// How paths become configurations of the target robot.
struct TransferParameters {
  double pose_spacing = 0.3;        ///< joint motion between transferred poses, joint units
  int max_poses_per_path = 64;      ///< 0: no limit
  int max_solutions = 5;            ///< L: configurations per pose
  double min_distance = 0.5;        ///< d: between the solutions of one pose, joint units
  double dropped_end_share = 0.15;  ///< of a path's length, left out at each end
  /// Number of tracks per path: configurations that follow the path without a jump, each with a
  /// posture like the source's, instead of independent ones. 0: none.
  int tracks = 3;
  double least_coverage = 0.9;  ///< of a path's poses that a track must cover to be kept, 0 to 1
  int track_candidates = 10;    ///< configurations among which the start of a track is chosen
  double shape_noise = 0.05;    ///< deviation of that choice, m
  /// Steps at each pose of a track that pull the target's arm towards the source's shape through
  /// its self-motion; four times as many at the start of the track. 0: none.
  int shape_steps = 5;
  bool avoid_self_collision = true;  ///< leaves out self-collisions of the target
  bool avoid_recorded_scene = true;  ///< and collisions with the path's recorded scene
  /// Whether waypoints of the same arm at the same place are taken over as configurations;
  /// otherwise they pass through inverse kinematics like those of other robots.
  bool take_over = true;

  bool operator==(const TransferParameters&) const = default;
};

/// Fields with limits are options of a profile's text. In the order of the digest.
template <>
inline constexpr std::tuple kFieldsOf<TransferParameters>{
    Field{"pose_spacing", &TransferParameters::pose_spacing, between(0.01, 10)},
    Field{"max_poses_per_path", &TransferParameters::max_poses_per_path, between(0, 4096)},
    Field{"max_solutions", &TransferParameters::max_solutions, between(1, 100)},
    Field{"min_distance", &TransferParameters::min_distance, between(0, 10)},
    Field{"dropped_end_share", &TransferParameters::dropped_end_share, between(0, 0.45)},
    Field{"tracks", &TransferParameters::tracks, between(0, 100)},
    Field{"least_coverage", &TransferParameters::least_coverage, between(0, 1)},
    Field{"track_candidates", &TransferParameters::track_candidates, between(1, 100)},
    Field{"shape_noise", &TransferParameters::shape_noise, between(0, 10)},
    Field{"shape_steps", &TransferParameters::shape_steps, between(0, 100)},
    Field{"avoid_self_collision", &TransferParameters::avoid_self_collision, between(0, 1)},
    Field{"avoid_recorded_scene", &TransferParameters::avoid_recorded_scene, between(0, 1)},
    Field{"take_over",
          &TransferParameters::take_over,
          {.min = 0, .max = 1, .mark = "inverse kinematics for every arm"}}};

/// Density estimator of configurations.
enum class Estimator : std::uint8_t {
  Mixture,  ///< K Gaussians, each with its own covariance
  Kernels,  ///< one Gaussian at each configuration, all with one covariance
};

/// For DensityParameters::prior: chosen by the score of held-out paths.
inline constexpr double kChosenPrior = -1;

/// How configurations become a mixture.
struct DensityParameters {
  /// K, lowered if there are too few configurations. 0: chosen by the score of held-out paths.
  int components = 100;
  double covariance_floor = 1e-4;            ///< added to each variance of a turning joint, rad^2
  double covariance_floor_m2 = 1e-4;         ///< of a prismatic joint, m^2
  bool equal_path_weights = true;            ///< every path weighs the same, at any length
  Weighting weighting = Weighting::Sources;  ///< of source robots
  /// Whether a refit may start from the previous mixture; otherwise every fit is a full one, and
  /// depends on the paths alone.
  bool warm_refits = true;
  Estimator estimator = Estimator::Mixture;  ///< Kernels need no `components` and no `prior`
  /// How strongly covariances are drawn towards their mean: as this many configurations in each
  /// component would (server/density). 0: not at all.
  double prior = kChosenPrior;

  bool operator==(const DensityParameters&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<DensityParameters>{
    Field{"components", &DensityParameters::components, between(0, 1000)},
    Field{"covariance_floor", &DensityParameters::covariance_floor, between(1e-8, 1)},
    Field{"covariance_floor_m2", &DensityParameters::covariance_floor_m2, between(1e-8, 1)},
    Field{"equal_path_weights", &DensityParameters::equal_path_weights, between(0, 1)},
    Field{"weighting", &DensityParameters::weighting},
    Field{"warm_refits", &DensityParameters::warm_refits, between(0, 1)},
    Field{"estimator", &DensityParameters::estimator, {.min = 0, .max = 1, .mark = "kernels"}},
    Field{"prior", &DensityParameters::prior, between(0, 10'000)}};

/// A named set of parameters. Its values, not its name, identify a distribution.
struct Profile {
  std::string name = "default";
  TransferParameters transfer;
  DensityParameters density;
  double recommended_share = 0.9;  ///< of guided samples, before there are attempts
  double thin_share = 0.5;         ///< the same for a thin distribution, if less
  std::uint64_t seed = 0;

  bool operator==(const Profile&) const = default;
};

/// `default` (the best known) or `paper` (exactly Lehner et al. 2022); empty otherwise.
std::optional<Profile> find_profile(std::string_view name);

}  // namespace kinship
