#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "client/planning/track_lanes.hpp"

namespace kinship::planning {

/// The tracks of one query, made when first asked for: a query that is a straight line never asks.
/// May be shared between threads.
class QueryTracks {
 public:
  /// \param make       called at most once; each track within the bounds.
  /// \param bounds     2 x dof, joint units.
  /// \param deviation  of samples from the configurations of tracks, each joint, joint units.
  /// \throws std::invalid_argument if the deviation is negative or not finite.
  QueryTracks(std::function<std::vector<Track>()> make, Eigen::Matrix2Xd bounds,
              double deviation);

  /// What is to be tried first comes first.
  std::span<const Track> tracks() const;

  /// Normal about a configuration of a track, each as likely as any other, within the bounds; empty
  /// if there is no track, or if no draw of many lay within.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator) const;

 private:
  const std::function<std::vector<Track>()> make_;
  const Eigen::Matrix2Xd bounds_;
  const double deviation_;
  mutable std::once_flag made_;
  mutable std::vector<Track> tracks_;
  mutable Eigen::MatrixXd configurations_;  // dof x n, of all tracks
};

}  // namespace kinship::planning
