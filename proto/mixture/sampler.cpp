#include "proto/mixture/sampler.hpp"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/split_mix.hpp"

namespace kinship::mixture {
namespace {

using Block = Eigen::Array4d;
constexpr Eigen::Index kBlock = Block::RowsAtCompileTime;

/// SplitMix64 as the standard library and Boost want their generators: four times as fast as a
/// Mersenne twister, and good enough for the some ten numbers of a sample.
class Bits {
 public:
  using result_type = std::uint64_t;

  explicit Bits(std::uint64_t seed) noexcept : state_(split_mixed(seed)) {}
  static constexpr result_type min() noexcept { return 0; }
  static constexpr result_type max() noexcept { return std::numeric_limits<result_type>::max(); }
  result_type operator()() noexcept {
    state_ += kSplitMixStep;
    return split_mixed(state_);
  }

 private:
  std::uint64_t state_;
};

Eigen::Index padded(Eigen::Index dimension) { return (dimension + kBlock - 1) / kBlock * kBlock; }

/// How many columns of a lower triangle are not zero in the block that begins at `row`.
Eigen::Index columns_of(Eigen::Index row, Eigen::Index dimension) {
  return std::min(row + kBlock, dimension);
}

/// A lower triangle as draws read it.
Eigen::ArrayXd packed(const Eigen::MatrixXd& factor) {
  const Eigen::Index dimension = factor.rows();
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(padded(dimension), dimension);
  rows.topRows(dimension) = factor;
  Eigen::ArrayXd blocks(padded(dimension) * dimension);
  Eigen::Index next = 0;
  for (Eigen::Index row = 0; row < rows.rows(); row += kBlock)
    for (Eigen::Index column = 0; column < columns_of(row, dimension); ++column, next += kBlock)
      blocks.segment<kBlock>(next) = rows.col(column).segment<kBlock>(row);
  blocks.conservativeResize(next);
  return blocks;
}

}  // namespace

/// A stream of draws, and the last of them.
struct Sampler::Draws {
  Draws(std::uint64_t seed, Eigen::Index dimension)
      : bits(seed), noise(dimension), configuration(padded(dimension)) {}

  Bits bits;
  boost::random::normal_distribution<double> normal;  // a ziggurat: the standard library's is slow
  Eigen::ArrayXd noise, configuration;
};

Sampler::Sampler(const Mixture& mixture, const Eigen::Matrix2Xd& limits)
    : dimension_(mixture.dimension()),
      cumulative_weights_(mixture.size()),
      means_(Eigen::ArrayXXd::Zero(padded(dimension_), mixture.size())) {
  if (limits.cols() != dimension_)
    throw std::invalid_argument("Sampler: limits do not fit the mixture");
  if (!(limits.row(0).array() <= limits.row(1).array()).all())
    throw std::invalid_argument("Sampler: a lower limit exceeds its upper limit");
  constexpr double kNone = std::numeric_limits<double>::infinity();
  lower_ = Eigen::ArrayXd::Constant(means_.rows(), -kNone);
  upper_ = Eigen::ArrayXd::Constant(means_.rows(), kNone);
  lower_.head(dimension_) = limits.row(0).transpose();
  upper_.head(dimension_) = limits.row(1).transpose();

  means_.topRows(dimension_) = mixture.means();
  const std::vector<Eigen::MatrixXd> factors = cholesky_factors(mixture);
  factors_.resize(packed(factors.front()).size(), static_cast<Eigen::Index>(factors.size()));
  for (Eigen::Index k = 0; k < factors_.cols(); ++k)
    factors_.col(k) = packed(factors[static_cast<std::size_t>(k)]);

  std::partial_sum(mixture.weights().begin(), mixture.weights().end(), cumulative_weights_.begin());
  Eigen::Index first = 0;
  for (Eigen::Index part = 0; part < mixture.size(); ++part) {
    const double weight = cumulative_weights_[mixture.size() - 1] * static_cast<double>(part) /
                          static_cast<double>(mixture.size());
    while (first + 1 < mixture.size() && cumulative_weights_[first] <= weight)
      ++first;
    guide_.push_back(first);
  }
}

/// \param share  of all weight, 0 to below 1.
/// Source: Chen and Asau, On generating random variates from an empirical distribution (1974).
Eigen::Index Sampler::component_at(double share) const noexcept {
  const Eigen::Index last = cumulative_weights_.size() - 1;
  const double weight = share * cumulative_weights_[last];
  Eigen::Index k = guide_[static_cast<std::size_t>(share * static_cast<double>(guide_.size()))];
  while (k > 0 && cumulative_weights_[k - 1] > weight)  // by rounding only
    --k;
  while (k < last && cumulative_weights_[k] <= weight)
    ++k;
  return k;
}

/// \return whether it is inside the limits.
bool Sampler::draw(Draws& draws) const noexcept {
  const Eigen::Index k = component_at(unit_interval(draws.bits()));
  for (double& value : draws.noise)
    value = draws.normal(draws.bits);
  const double* factor = factors_.col(factors_.cols() == 1 ? 0 : k).data();
  Block beyond = Block::Constant(-std::numeric_limits<double>::infinity());  // a limit, by row
  for (Eigen::Index row = 0; row < means_.rows(); row += kBlock) {
    Block sum = means_.col(k).segment<kBlock>(row);
    const Eigen::Index columns = columns_of(row, dimension_);
    for (Eigen::Index column = 0; column < columns; ++column, factor += kBlock)
      sum += Eigen::Map<const Block>(factor) * draws.noise[column];
    beyond = beyond.max(lower_.segment<kBlock>(row) - sum).max(sum - upper_.segment<kBlock>(row));
    draws.configuration.segment<kBlock>(row) = sum;
  }
  return beyond.maxCoeff() <= 0;
}

bool Sampler::draw_inside(Draws& draws) const noexcept {
  for (int i = 0; i < kMaxDraws; ++i)
    if (draw(draws))
      return true;
  return false;
}

std::optional<Eigen::VectorXd> Sampler::sample(std::mt19937_64& generator) const {
  Draws draws(generator(), dimension_);
  if (!draw_inside(draws))
    return std::nullopt;
  return draws.configuration.head(dimension_);
}

Eigen::MatrixXd Sampler::sample(std::mt19937_64& generator, Eigen::Index count) const {
  Draws draws(generator(), dimension_);
  Eigen::MatrixXd samples(dimension_, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!draw_inside(draws))
      return samples.leftCols(i);
    samples.col(i) = draws.configuration.head(dimension_);
  }
  return samples;
}

}  // namespace kinship::mixture
