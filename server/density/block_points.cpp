#include "server/density/block_points.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "proto/types/stopped.hpp"

namespace kinship::density {
namespace {

using Rank = std::uint32_t;  // of a distinct point

/// Orders points so that each kBlockPoints in a row are neighbours: halves by the median of the
/// joint that spreads most, again and again (a k-d tree of which only the leaves are kept).
class NeighbourOrder {
 public:
  NeighbourOrder(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                 const std::vector<std::uint32_t>& columns, const std::stop_token& stop)
      : configurations_(configurations), columns_(columns), stop_(stop), places_(columns.size()) {
    for (std::size_t i = 0; i < places_.size(); ++i)
      places_[i].rank = static_cast<Rank>(i);
    order(0, places_.size());
  }
  std::vector<Rank> ranks() const {
    std::vector<Rank> ranks;
    ranks.reserve(places_.size());
    for (const Place& place : places_)
      ranks.push_back(place.rank);
    return ranks;
  }

 private:
  /// A point and its value of the joint that is being halved: looked up once a halving, since
  /// points lie far apart in memory.
  struct Place {
    double value = 0;
    Rank rank = 0;
  };

  void order(std::size_t begin, std::size_t end) {
    while (end - begin > kBlockPoints) {
      throw_if_stopped(stop_);
      const std::size_t blocks = (end - begin + kBlockPoints - 1) / kBlockPoints;
      const std::size_t middle = begin + blocks / 2 * kBlockPoints;
      const Eigen::Index joint = widest_joint(begin, end);
      for (std::size_t i = begin; i < end; ++i)
        places_[i].value = configurations_(joint, columns_[places_[i].rank]);
      const auto at = [this](std::size_t i) {
        return places_.begin() + static_cast<std::ptrdiff_t>(i);
      };
      std::nth_element(at(begin), at(middle), at(end),
                       [](const Place& a, const Place& b) { return a.value < b.value; });
      order(begin, middle);
      begin = middle;
    }
  }

  /// Of some hundred of the points: it need not be exact.
  Eigen::Index widest_joint(std::size_t begin, std::size_t end) const {
    const std::size_t step = (end - begin) / 256 + 1;
    Eigen::VectorXd least = configurations_.col(columns_[places_[begin].rank]);
    Eigen::VectorXd most = least;
    for (std::size_t i = begin; i < end; i += step) {
      const Eigen::Ref<const Eigen::VectorXd> point =
          configurations_.col(columns_[places_[i].rank]);
      least = least.cwiseMin(point);
      most = most.cwiseMax(point);
    }
    Eigen::Index widest = 0;
    (most - least).maxCoeff(&widest);
    return widest;
  }

  const Eigen::Ref<const Eigen::MatrixXd>& configurations_;
  const std::vector<std::uint32_t>& columns_;
  const std::stop_token& stop_;
  std::vector<Place> places_;
};

}  // namespace

BlockPoints::BlockPoints(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                         DistinctPoints distinct, Eigen::VectorXd offset,
                         const std::stop_token& stop)
    : offset_(std::move(offset)), size_(static_cast<Eigen::Index>(distinct.columns.size())) {
  const std::vector<Rank> order = NeighbourOrder(configurations, distinct.columns, stop).ranks();
  const auto count = static_cast<int>((size_ + kBlockPoints - 1) / kBlockPoints);
  const auto padded = static_cast<std::size_t>(count) * kBlockPoints;
  points_.resize(padded * static_cast<std::size_t>(dimension()));
  weights_.assign(padded, 0.0);
  centres_.resize(dimension(), count);
  half_widths_.resize(dimension(), count);
  for (int block = 0; block < count; ++block) {
    throw_if_stopped(stop);
    const std::size_t first = static_cast<std::size_t>(block) * kBlockPoints;
    Eigen::Map<Eigen::MatrixXd> rows(points_.data() + first * static_cast<std::size_t>(dimension()),
                                     kBlockPoints, dimension());
    for (std::size_t i = 0; i < kBlockPoints; ++i) {
      const Rank rank = order[std::min(first + i, order.size() - 1)];
      rows.row(static_cast<Eigen::Index>(i)) =
          (configurations.col(distinct.columns[rank]) - offset_).transpose();
      if (first + i < order.size())
        weights_[first + i] = distinct.weights[rank];
    }
    const Eigen::VectorXd least = rows.colwise().minCoeff().transpose();
    const Eigen::VectorXd most = rows.colwise().maxCoeff().transpose();
    centres_.col(block) = (least + most) / 2;
    half_widths_.col(block) = (most - least) / 2;
  }
  total_weight_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
}

Eigen::VectorXd BlockPoints::point(Eigen::Index index) const {
  Eigen::VectorXd point(dimension());
  const double* rows = points(static_cast<int>(index / kBlockPoints));
  for (int joint = 0; joint < dimension(); ++joint)
    point[joint] = rows[joint * kBlockPoints + index % kBlockPoints];
  return point;
}

Eigen::VectorXd mean_of(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                        const DistinctPoints& distinct) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(configurations.rows());
  for (std::size_t i = 0; i < distinct.columns.size(); ++i)
    sum += distinct.weights[i] * configurations.col(distinct.columns[i]);
  return sum / std::accumulate(distinct.weights.begin(), distinct.weights.end(), 0.0);
}

BlockPoints thinned(const BlockPoints& points, Eigen::Index count) {
  Eigen::MatrixXd sample(points.dimension(), std::min(count, points.size()));
  DistinctPoints chosen;
  for (Eigen::Index i = 0; i < sample.cols(); ++i) {
    const Eigen::Index index = i * points.size() / sample.cols();
    sample.col(i) = points.point(index) + points.offset();
    chosen.columns.push_back(static_cast<std::uint32_t>(i));
    chosen.weights.push_back(points.weight(index));
  }
  const double total = std::accumulate(chosen.weights.begin(), chosen.weights.end(), 0.0);
  for (double& weight : chosen.weights)
    weight *= static_cast<double>(sample.cols()) / total;
  return {sample, std::move(chosen), points.offset()};
}

}  // namespace kinship::density
