#include "server/density/expectation_maximisation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "proto/types/stopped.hpp"
#include "server/density/aligned_numbers.hpp"
#include "server/density/packed_mixture.hpp"
#include "server/density/parallel.hpp"

namespace kinship::density {
namespace {

constexpr int kMaxChunks = 32;

/// A mixture at the points of one block at a time. Memory of one thread's work.
class BlockPosterior {
 public:
  /// \param mixture, kernels  outlive it.
  BlockPosterior(const PackedMixture& mixture, const SimdKernels& kernels, bool prune);

  void evaluate(const BlockPoints& points, int block);

  /// Of the last block: the components that count there, and per component a row.
  int count() const noexcept { return count_; }
  int component(int row) const { return candidates_[static_cast<std::size_t>(row)]; }
  const double* responsibilities(int row) const noexcept {
    return terms_.data() + static_cast<std::ptrdiff_t>(row) * kBlockPoints;
  }
  /// The greatest responsibility of a row.
  double peak(int row) const { return peaks_[static_cast<std::size_t>(row)]; }
  const double* log_densities() const noexcept { return log_densities_; }  ///< kBlockPoints

  /// A term so far below the largest one of a point is negligible, nats.
  static constexpr double kNegligible = 42;

 private:
  void choose_candidates(const BlockPoints& points, int block);
  double upper_bound(int component) const { return bounds_[static_cast<std::size_t>(component)]; }

  const PackedMixture& mixture_;
  const SimdKernels& kernels_;
  const bool prune_;
  AlignedNumbers bounds_;  // 3 x stride: upper, lower, at the centre
  AlignedNumbers terms_;   // K x kBlockPoints
  std::vector<int> candidates_;
  std::vector<std::pair<double, int>> order_;  // of candidates: keys of their order
  double best_lower_bound_ = 0;
  int count_ = 0;
  std::vector<double> peaks_;
  alignas(64) double largest_[kBlockPoints] = {};
  alignas(64) double log_densities_[kBlockPoints] = {};
};

BlockPosterior::BlockPosterior(const PackedMixture& mixture, const SimdKernels& kernels, bool prune)
    : mixture_(mixture), kernels_(kernels), prune_(prune) {
  const auto size = static_cast<std::size_t>(mixture.size());
  bounds_.resize(3 * static_cast<std::size_t>(mixture.stride()));
  terms_.resize(size * kBlockPoints);
  peaks_.resize(size);
  candidates_.reserve(size);
}

/// Components that may count somewhere in the block's box, the likeliest first.
void BlockPosterior::choose_candidates(const BlockPoints& points, int block) {
  kernels_.bounds(mixture_.dimension(), mixture_.interleaved(), mixture_.stride(),
                  points.centre(block), points.half_widths(block), bounds_.data());
  const double* lower = bounds_.data() + mixture_.stride();
  const double* at_centre = lower + mixture_.stride();
  best_lower_bound_ = *std::max_element(lower, lower + mixture_.size());
  order_.clear();
  for (int k = 0; k < mixture_.size(); ++k)
    if (upper_bound(k) >= best_lower_bound_ - kNegligible)
      order_.emplace_back(-at_centre[k], k);
  std::sort(order_.begin(), order_.end());
  for (const auto& [key, k] : order_)
    candidates_.push_back(k);
}

void BlockPosterior::evaluate(const BlockPoints& points, int block) {
  candidates_.clear();
  if (prune_) {
    choose_candidates(points, block);
  } else {
    candidates_.resize(static_cast<std::size_t>(mixture_.size()));
    std::iota(candidates_.begin(), candidates_.end(), 0);
  }
  std::fill_n(largest_, kBlockPoints, std::numeric_limits<double>::lowest());
  double floor = prune_ ? best_lower_bound_ : 0;  // no point's largest term is below it
  std::size_t count = 0;
  for (const int k : candidates_) {
    if (prune_ && upper_bound(k) < floor - kNegligible)
      continue;
    double least_largest = 0;
    const double excess =
        kernels_.log_terms(mixture_.dimension(), points.points(block), mixture_.component(k),
                           terms_.data() + count * kBlockPoints, largest_, &least_largest);
    if (prune_ && excess < -kNegligible)
      continue;
    floor = std::max(floor, least_largest);
    candidates_[count++] = k;
  }
  count_ = static_cast<int>(count);
  kernels_.responsibilities(count_, terms_.data(), largest_, peaks_.data(), log_densities_);
}

/// How many parts a sum over blocks has: a function of the sizes alone, so that its value does not
/// depend on the threads; few enough that their sums take no more memory than the points.
int chunks(const BlockPoints& points, int numbers_per_chunk) {
  const double numbers = static_cast<double>(points.blocks()) * kBlockPoints * points.dimension();
  return static_cast<int>(std::clamp(numbers / numbers_per_chunk, 1.0,
                                     static_cast<double>(std::min(kMaxChunks, points.blocks()))));
}

int begin_of_chunk(const BlockPoints& points, int chunk, int count) {
  return static_cast<int>(static_cast<std::int64_t>(points.blocks()) * chunk / count);
}

/// The sums of one chunk.
struct Partial {
  AlignedNumbers sums;  // packed_size(d) x K, component by component
  double log_likelihood = 0;
};

void add_block(const BlockPoints& points, int block, const BlockPosterior& posterior,
               const Computation& computation, Partial& partial) {
  const int packed = packed_size(points.dimension());
  const double least_peak = computation.prune ? std::exp(-BlockPosterior::kNegligible) : 0;
  const double* weights = points.weights(block);
  for (int i = 0; i < kBlockPoints; ++i)
    partial.log_likelihood += weights[i] * posterior.log_densities()[i];
  for (int row = 0; row < posterior.count(); ++row)
    if (posterior.peak(row) > least_peak)
      computation.kernels->add_moments(
          points.dimension(), points.points(block), posterior.responsibilities(row), weights,
          partial.sums.data() + static_cast<std::ptrdiff_t>(posterior.component(row)) * packed);
}

/// \param visit  called with each block of a chunk, in order, and its posterior.
template <typename Visit>
void visit_blocks(const PackedMixture& packed, const BlockPoints& points, int chunk_count,
                  const Computation& computation, const Visit& visit) {
  for_each_part(computation.threads, chunk_count, [&](int chunk) {
    BlockPosterior posterior(packed, *computation.kernels, computation.prune);
    const int end = begin_of_chunk(points, chunk + 1, chunk_count);
    for (int block = begin_of_chunk(points, chunk, chunk_count); block < end; ++block) {
      throw_if_stopped(computation.stop);
      posterior.evaluate(points, block);
      visit(chunk, block, posterior);
    }
  });
}

}  // namespace

Expectation expectation(const Mixture& mixture, const BlockPoints& points,
                        const Computation& computation) {
  const PackedMixture packed(mixture, points.offset());
  const int numbers = packed_size(points.dimension()) * packed.size();
  const int count = chunks(points, numbers);
  std::vector<Partial> partials(static_cast<std::size_t>(count));
  for (Partial& partial : partials)
    partial.sums.assign(static_cast<std::size_t>(numbers), 0.0);
  visit_blocks(packed, points, count, computation,
               [&](int chunk, int block, const BlockPosterior& posterior) {
                 add_block(points, block, posterior, computation,
                           partials[static_cast<std::size_t>(chunk)]);
               });

  Expectation result;
  result.moments.dimension = points.dimension();
  result.moments.sums = Eigen::MatrixXd::Zero(packed_size(points.dimension()), packed.size());
  for (const Partial& partial : partials) {
    result.moments.sums += Eigen::Map<const Eigen::MatrixXd>(
        partial.sums.data(), result.moments.sums.rows(), result.moments.sums.cols());
    result.mean_log_likelihood += partial.log_likelihood;
  }
  result.mean_log_likelihood /= points.total_weight();
  return result;
}

double mean_log_density(const Mixture& mixture, const BlockPoints& points, double background_share,
                        double log_background, const Computation& computation) {
  const PackedMixture packed(mixture, points.offset());
  const int count = chunks(points, 1);
  const double background =
      background_share > 0 ? std::log(background_share) + log_background : -1e300;
  const double log_share = std::log1p(-background_share);
  std::vector<double> sums(static_cast<std::size_t>(count), 0.0);
  visit_blocks(packed, points, count, computation,
               [&](int chunk, int block, const BlockPosterior& posterior) {
                 for (int i = 0; i < kBlockPoints; ++i) {
                   const double fitted = log_share + posterior.log_densities()[i];
                   const double most = std::max(fitted, background);
                   const double least = std::min(fitted, background);
                   sums[static_cast<std::size_t>(chunk)] +=
                       points.weights(block)[i] * (most + std::log1p(std::exp(least - most)));
                 }
               });
  double total = 0;
  for (const double sum : sums)
    total += sum;
  return total / points.total_weight();
}

Eigen::VectorXd log_densities(const Mixture& mixture, const BlockPoints& points,
                              const Computation& computation) {
  const PackedMixture packed(mixture, points.offset());
  Eigen::VectorXd densities(points.size());
  visit_blocks(packed, points, chunks(points, 1), computation,
               [&](int, int block, const BlockPosterior& posterior) {
                 const Eigen::Index first = Eigen::Index{block} * kBlockPoints;
                 std::copy_n(posterior.log_densities(),
                             std::min<Eigen::Index>(kBlockPoints, points.size() - first),
                             densities.data() + first);
               });
  return densities;
}

Mixture maximisation(const Moments& moments, const Eigen::VectorXd& offset,
                     const Eigen::VectorXd& floors, const Eigen::MatrixXd& prior_scatter,
                     double least_mass_share) {
  const Eigen::Index dimension = moments.dimension;
  const double least_mass = std::min(least_mass_share * static_cast<double>(dimension + 1),
                                     moments.sums.row(0).maxCoeff());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < moments.components(); ++k)
    if (moments.mass(k) >= least_mass)
      kept.push_back(k);

  Eigen::VectorXd weights(static_cast<Eigen::Index>(kept.size()));
  Eigen::MatrixXd means(dimension, weights.size());
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index column = 0; column < weights.size(); ++column) {
    const Eigen::Index k = kept[static_cast<std::size_t>(column)];
    const double mass = moments.mass(k);
    const Eigen::VectorXd mean = moments.sums.col(k).segment(1, dimension) / mass;
    weights[column] = mass;
    means.col(column) = mean + offset;
    Eigen::MatrixXd covariance(dimension, dimension);
    Eigen::Index entry = 1 + dimension;
    for (Eigen::Index i = 0; i < dimension; ++i)
      for (Eigen::Index j = i; j < dimension; ++j) {
        covariance(i, j) = moments.sums(entry++, k) / mass - mean[i] * mean[j];
        covariance(j, i) = covariance(i, j);
      }
    covariance.diagonal() = covariance.diagonal().cwiseMax(0) + floors;
    if (prior_scatter.size() > 0)
      covariance += prior_scatter / mass;
    covariances.push_back(std::move(covariance));
  }
  return {weights / weights.sum(), std::move(means), std::move(covariances)};
}

}  // namespace kinship::density
