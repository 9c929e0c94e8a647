#include "server/density/kmeans.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "proto/types/stopped.hpp"

namespace kinship::density {
namespace {

/// Squared distance from a place to the nearest point of a block's box.
double nearest_in_box(const BlockPoints& points, int block, const double* place) {
  double squared = 0;
  for (int joint = 0; joint < points.dimension(); ++joint) {
    const double beyond =
        std::abs(place[joint] - points.centre(block)[joint]) - points.half_widths(block)[joint];
    squared += beyond > 0 ? beyond * beyond : 0;
  }
  return squared;
}

/// And to the furthest.
double furthest_in_box(const BlockPoints& points, int block, const double* place) {
  double squared = 0;
  for (int joint = 0; joint < points.dimension(); ++joint) {
    const double across =
        std::abs(place[joint] - points.centre(block)[joint]) + points.half_widths(block)[joint];
    squared += across * across;
  }
  return squared;
}

/// How far each point is from the nearest centre chosen so far.
class Distances {
 public:
  Distances(const BlockPoints& points, const SimdKernels& kernels)
      : points_(points),
        kernels_(kernels),
        squared_(static_cast<std::size_t>(points.blocks()) * kBlockPoints,
                 std::numeric_limits<double>::max()),
        sums_(static_cast<std::size_t>(points.blocks()), 0.0),
        furthest_(sums_.size(), std::numeric_limits<double>::max()) {}

  /// The changes that a new centre would make.
  struct Change {
    double total = 0;
    std::vector<int> blocks;
    AlignedNumbers squared;  // kBlockPoints per changed block
    std::vector<double> sums;
  };

  void try_centre(const double* centre, Change& change) const {
    change.total = 0;
    change.blocks.clear();
    change.sums.clear();
    change.squared.resize(squared_.size());
    for (int block = 0; block < points_.blocks(); ++block) {
      const auto index = static_cast<std::size_t>(block);
      if (nearest_in_box(points_, block, centre) >= furthest_[index]) {
        change.total += sums_[index];
        continue;
      }
      change.sums.push_back(
          kernels_.nearer(points_.dimension(), points_.points(block), points_.weights(block),
                          centre, squared_.data() + index * kBlockPoints,
                          change.squared.data() + change.blocks.size() * kBlockPoints));
      change.blocks.push_back(block);
      change.total += change.sums.back();
    }
  }

  void apply(const Change& change) {
    for (std::size_t i = 0; i < change.blocks.size(); ++i) {
      const auto block = static_cast<std::size_t>(change.blocks[i]);
      const auto from = change.squared.begin() + static_cast<std::ptrdiff_t>(i * kBlockPoints);
      std::copy_n(from, kBlockPoints,
                  squared_.begin() + static_cast<std::ptrdiff_t>(block * kBlockPoints));
      sums_[block] = change.sums[i];
      furthest_[block] = *std::max_element(from, from + kBlockPoints);
    }
    total_ = change.total;
  }

  double total() const noexcept { return total_; }

  /// A point with probability proportional to its weight times its squared distance.
  Eigen::Index draw(std::mt19937_64& generator) const {
    double remaining = std::uniform_real_distribution<double>(0, total_)(generator);
    std::size_t block = 0;
    while (block + 1 < sums_.size() && remaining >= sums_[block])
      remaining -= sums_[block++];
    const auto first = static_cast<Eigen::Index>(block * kBlockPoints);
    Eigen::Index last = first;
    for (Eigen::Index i = first; i < first + kBlockPoints; ++i) {
      const double mass = points_.weight(i) * squared_[static_cast<std::size_t>(i)];
      if (mass <= 0)
        continue;
      last = i;
      remaining -= mass;
      if (remaining < 0)
        break;
    }
    return last;
  }

 private:
  const BlockPoints& points_;
  const SimdKernels& kernels_;
  AlignedNumbers squared_;
  std::vector<double> sums_, furthest_;  // per block
  double total_ = 0;
};

/// A point with probability proportional to its weight.
Eigen::Index draw_point(const BlockPoints& points, std::mt19937_64& generator) {
  double remaining = std::uniform_real_distribution<double>(0, points.total_weight())(generator);
  Eigen::Index index = 0;
  while (index + 1 < points.size() && remaining >= points.weight(index))
    remaining -= points.weight(index++);
  return index;
}

/// \param visit  called with each point: its index in block order, and where joint 0 of it is; the
///               next joint is kBlockPoints further on.
template <typename Visit>
void visit_points(const BlockPoints& points, const Visit& visit) {
  for (int block = 0; block < points.blocks(); ++block) {
    const Eigen::Index first = Eigen::Index{block} * kBlockPoints;
    const Eigen::Index count = std::min<Eigen::Index>(kBlockPoints, points.size() - first);
    for (Eigen::Index i = 0; i < count; ++i)
      visit(first + i, points.points(block) + i);
  }
}

/// The centres that can be nearest to a point of the block.
void find_candidates(const BlockPoints& points, int block,
                     const Eigen::Ref<const Eigen::MatrixXd>& centres, std::vector<int>& found) {
  double reach = std::numeric_limits<double>::max();
  for (Eigen::Index k = 0; k < centres.cols(); ++k)
    reach = std::min(reach, furthest_in_box(points, block, centres.col(k).data()));
  reach *= 1 + 1e-12;  // two ways to round the same number
  found.clear();
  for (Eigen::Index k = 0; k < centres.cols(); ++k)
    if (nearest_in_box(points, block, centres.col(k).data()) <= reach)
      found.push_back(static_cast<int>(k));
}

}  // namespace

Eigen::MatrixXd choose_centres(const BlockPoints& points, Eigen::Index count,
                               const SimdKernels& kernels, std::mt19937_64& generator,
                               const std::stop_token& stop) {
  const int tries = 2 + static_cast<int>(std::log(static_cast<double>(count)));
  Eigen::MatrixXd centres(points.dimension(), count);
  Distances distances(points, kernels);
  Distances::Change best, other;
  centres.col(0) = points.point(draw_point(points, generator));
  distances.try_centre(centres.col(0).data(), best);
  distances.apply(best);
  for (Eigen::Index chosen = 1; chosen < count; ++chosen) {
    throw_if_stopped(stop);
    if (!(distances.total() > 0))
      return centres.leftCols(chosen);  // every point is a centre already
    for (int attempt = 0; attempt < tries; ++attempt) {
      const Eigen::VectorXd candidate = points.point(distances.draw(generator));
      distances.try_centre(candidate.data(), other);
      if (attempt > 0 && other.total >= best.total)
        continue;
      std::swap(best, other);
      centres.col(chosen) = candidate;
    }
    distances.apply(best);
  }
  return centres;
}

std::vector<int> nearest_centres(const BlockPoints& points,
                                 const Eigen::Ref<const Eigen::MatrixXd>& centres,
                                 const SimdKernels& kernels, const std::stop_token& stop) {
  std::vector<int> nearest(static_cast<std::size_t>(points.size()));
  std::vector<int> candidates;
  Eigen::MatrixXd near(centres.rows(), centres.cols());
  alignas(64) double chosen[kBlockPoints];
  for (int block = 0; block < points.blocks(); ++block) {
    throw_if_stopped(stop);
    find_candidates(points, block, centres, candidates);
    for (std::size_t i = 0; i < candidates.size(); ++i)
      near.col(static_cast<Eigen::Index>(i)) = centres.col(candidates[i]);
    kernels.nearest(points.dimension(), points.points(block), static_cast<int>(candidates.size()),
                    near.data(), chosen);
    const std::size_t first = static_cast<std::size_t>(block) * kBlockPoints;
    for (std::size_t i = 0; i < kBlockPoints && first + i < nearest.size(); ++i)
      nearest[first + i] = candidates[static_cast<std::size_t>(chosen[i])];
  }
  return nearest;
}

Eigen::MatrixXd move_centres(const BlockPoints& points, Eigen::MatrixXd centres, int max_iterations,
                             const SimdKernels& kernels, const std::stop_token& stop) {
  std::vector<int> previous;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::vector<int> nearest = nearest_centres(points, centres, kernels, stop);
    if (nearest == previous)
      break;
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres.rows(), centres.cols());
    Eigen::VectorXd masses = Eigen::VectorXd::Zero(centres.cols());
    visit_points(points, [&](Eigen::Index i, const double* point) {
      const int k = nearest[static_cast<std::size_t>(i)];
      double* const sum = sums.col(k).data();
      for (int joint = 0; joint < points.dimension(); ++joint)
        sum[joint] += points.weight(i) * point[joint * kBlockPoints];
      masses[k] += points.weight(i);
    });
    for (Eigen::Index k = 0; k < centres.cols(); ++k)
      if (masses[k] > 0)
        centres.col(k) = sums.col(k) / masses[k];
    previous = std::move(nearest);
  }
  return centres;
}

Moments moments_of_clusters(const BlockPoints& points, const std::vector<int>& component_of_point,
                            Eigen::Index components) {
  const int dimension = points.dimension();
  Moments moments{Eigen::MatrixXd::Zero(packed_size(dimension), components), dimension};
  visit_points(points, [&](Eigen::Index i, const double* point) {
    double* sum = moments.sums.col(component_of_point[static_cast<std::size_t>(i)]).data();
    const double weight = points.weight(i);
    *sum++ += weight;
    for (int row = 0; row < dimension; ++row)
      *sum++ += weight * point[row * kBlockPoints];
    for (int row = 0; row < dimension; ++row) {
      const double weighted = weight * point[row * kBlockPoints];
      for (int column = row; column < dimension; ++column)
        *sum++ += weighted * point[column * kBlockPoints];
    }
  });
  return moments;
}

}  // namespace kinship::density
