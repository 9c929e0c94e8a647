#include "robots/planning/query_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

namespace kinship::planning {

QueryTracks::QueryTracks(std::shared_ptr<const ExperienceGuide> guide, TrackQuery query,
                         const TrackOptions& options)
    : guide_(std::move(guide)), query_(std::move(query)), options_(options) {
  if (!(options.deviation >= 0) || !std::isfinite(options.deviation))
    throw std::invalid_argument("QueryTracks: the deviation is negative or not finite");
}

void QueryTracks::make_some() {
  if (!choices_)
    choices_ = guide_->choose(query_, options_);
  const std::size_t count = std::min<std::size_t>(inverse::kLanes, choices_->size() - followed_);
  for (Track& track :
       guide_->follow(query_, std::span(*choices_).subspan(followed_, count), options_)) {
    for (const auto& q : track.configurations.colwise())
      configurations_.emplace_back(q);
    tracks_.push_back(std::move(track));
  }
  followed_ += count;
}

const Track* QueryTracks::track(std::size_t index) {
  while (index >= tracks_.size() && (!choices_ || followed_ < choices_->size()))
    make_some();
  return index < tracks_.size() ? &tracks_[index] : nullptr;
}

std::optional<Eigen::VectorXd> QueryTracks::sample(std::mt19937_64& generator) {
  if (track(0) == nullptr)
    return std::nullopt;
  constexpr int kMaxDraws = 100;
  std::uniform_int_distribution<std::size_t> index(0, configurations_.size() - 1);
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd q(query_.bounds.cols());
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const Eigen::VectorXd& mean = configurations_[index(generator)];
    bool inside = true;
    for (Eigen::Index joint = 0; joint < q.size() && inside; ++joint) {
      q[joint] = mean[joint] + options_.deviation * normal(generator);
      inside = q[joint] >= query_.bounds(0, joint) && q[joint] <= query_.bounds(1, joint);
    }
    if (inside)
      return q;
  }
  return std::nullopt;
}

}  // namespace kinship::planning
