#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "proto/types/advice.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/field.hpp"
#include "proto/types/fit_origin.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/selection.hpp"
#include "proto/types/source.hpp"
#include "proto/types/uuid.hpp"

namespace kinship {

/// Score of a number of components on configurations of held-out paths.
struct ComponentScore {
  int components = 0;
  /// Weighted mean over held-out configurations of log(0.99 p + 0.01 u), nats: p the density of the
  /// mixture of the other paths, u that of the uniform distribution within the limits.
  double score = 0;

  bool operator==(const ComponentScore&) const = default;
};

template <>
inline constexpr std::tuple kFieldsOf<ComponentScore>{
    Field{"K", &ComponentScore::components, {.min = 1, .max = kMaxComponents}},
    Field{"score", &ComponentScore::score}};

/// Ready: there is a mixture. Failed: transfer or fit failed; `reason` says why. Thin: there is a
/// mixture, made of a small part of the experience (see kThinShare in server/fitting).
enum class DistributionState { Ready, Failed, Thin };

/// Whether a distribution of this state has a mixture.
constexpr bool has_mixture(DistributionState state) { return state != DistributionState::Failed; }

/// A mixture fitted for one robot and task, with its provenance.
struct Distribution {
  Digest id;                   ///< digest of the key: task, robot, placement, parameters, engines
  std::uint64_t revision = 0;  ///< durable counter per id
  Uuid store_epoch;
  std::string task;
  Digest robot;
  std::optional<Eigen::Isometry3d> T_task_base;  ///< snapped
  std::string profile;
  Selection selection;  ///< sources and since as requested; weighting as used
  std::string engines;  ///< versions of the transfer and density code, e.g. "transfer 1, density 1"
  DistributionState state = DistributionState::Ready;
  std::string reason;  ///< why Failed; a warning otherwise, mostly empty
  std::vector<Source> sources;
  std::uint64_t configurations = 0;  ///< number to which the mixture was fitted
  std::optional<Mixture> mixture;    ///< present exactly unless Failed
  Eigen::Matrix2Xd limits;           ///< 2 x dof: lower, upper; joint units
  /// If the number of components was chosen: the highest score of `component_scores`; if a prior or
  /// a bandwidth was, the score of that. Both are from the last full fit.
  std::optional<double> held_out_score;
  /// At the time of the reply, not of the fit.
  Advice advice;
  std::int64_t fitted_ms = 0;  ///< Unix time, UTC
  double transfer_time_s = 0;
  double fit_time_s = 0;
  std::vector<ComponentScore> component_scores;  ///< falling number of components; mostly empty
  /// Per joint, the branch cut of a continuous one: means and limits lie in [cut, cut + 2 pi].
  /// Empty if no joint is continuous.
  std::vector<std::optional<double>> cuts;
  std::optional<FitOrigin> fit;  ///< of its mixture; missing if it failed
  /// Filters of its configurations, and those not applied and why, as text.
  std::string filters = {};
};

/// The last fields of a distribution in messages, documents and blobs alike; new ones come here.
inline constexpr std::tuple kLastFieldsOfDistribution{
    Field{"filters", &Distribution::filters, {.limit = kMaxMessageBytes}}};

}  // namespace kinship
