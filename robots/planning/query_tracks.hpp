#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "robots/planning/experience_guide.hpp"

namespace kinship::planning {

/// The tracks of one query, made a few at a time on demand: a query solved by a straight line makes
/// none. Used by one thread.
class QueryTracks {
 public:
  /// \param guide  not null.
  /// \throws std::invalid_argument if the deviation is negative or not finite.
  QueryTracks(std::shared_ptr<const ExperienceGuide> guide, TrackQuery query,
              const TrackOptions& options);

  /// \return null: there are no more.
  const Track* track(std::size_t index);

  /// A normal sample about a configuration of the tracks made so far, all equally likely, within
  /// the bounds; empty if there is no track, or if no draw of many lay within.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator);

 private:
  void make_some();

  const std::shared_ptr<const ExperienceGuide> guide_;
  const TrackQuery query_;
  const TrackOptions options_;
  std::optional<std::vector<ExperienceGuide::Choice>> choices_;  // not made yet
  std::size_t followed_ = 0;                                     // of the choices
  std::vector<Track> tracks_;
  std::vector<Eigen::VectorXd> configurations_;  // of all tracks
};

}  // namespace kinship::planning
