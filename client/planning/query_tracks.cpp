#include "client/planning/query_tracks.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace kinship::planning {

QueryTracks::QueryTracks(std::function<std::vector<Track>()> make, Eigen::Matrix2Xd bounds,
                         double deviation)
    : make_(std::move(make)), bounds_(std::move(bounds)), deviation_(deviation) {
  if (!(deviation >= 0) || !std::isfinite(deviation))
    throw std::invalid_argument("QueryTracks: the deviation is negative or not finite");
}

std::span<const Track> QueryTracks::tracks() const {
  std::call_once(made_, [this] {
    tracks_ = make_();
    Eigen::Index count = 0;
    for (const Track& track : tracks_)
      count += track.configurations.cols();
    configurations_.resize(bounds_.cols(), count);
    count = 0;
    for (const Track& track : tracks_) {
      configurations_.middleCols(count, track.configurations.cols()) = track.configurations;
      count += track.configurations.cols();
    }
  });
  return tracks_;
}

std::optional<Eigen::VectorXd> QueryTracks::sample(std::mt19937_64& generator) const {
  if (tracks().empty())
    return std::nullopt;
  constexpr int kMaxDraws = 100;
  std::uniform_int_distribution<Eigen::Index> index(0, configurations_.cols() - 1);
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd q(bounds_.cols());
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const auto mean = configurations_.col(index(generator));
    bool inside = true;
    for (Eigen::Index joint = 0; joint < q.size() && inside; ++joint) {
      q[joint] = mean[joint] + deviation_ * normal(generator);
      inside = q[joint] >= bounds_(0, joint) && q[joint] <= bounds_(1, joint);
    }
    if (inside)
      return q;
  }
  return std::nullopt;
}

}  // namespace kinship::planning
