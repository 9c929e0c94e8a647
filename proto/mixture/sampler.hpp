#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "proto/types/mixture.hpp"

namespace kinship::mixture {

/// Draws configurations from a mixture truncated to joint limits, by rejection of whole draws
/// (including the component, so that the samples follow the truncated mixture). Immutable after
/// construction: may be shared between threads with a generator each.
class Sampler {
 public:
  /// \param limits  2 x d: lower, upper, joint units.
  /// \throws std::invalid_argument if shapes differ or a lower limit exceeds its upper.
  /// \throws Failure(Internal) if a covariance is not positive definite.
  Sampler(const Mixture& mixture, const Eigen::Matrix2Xd& limits);

  Eigen::Index dimension() const noexcept { return dimension_; }

  /// One configuration inside the limits; empty if none of `kMaxDraws` draws is inside, i.e. the
  /// mixture lies outside the limits. Takes one number from the generator.
  std::optional<Eigen::VectorXd> sample(std::mt19937_64& generator) const;

  /// Many configurations at once, in a fraction of the time of single ones. Takes one number from
  /// the generator.
  /// \return d x count; fewer columns if none of `kMaxDraws` draws is inside.
  Eigen::MatrixXd sample(std::mt19937_64& generator, Eigen::Index count) const;

  static constexpr int kMaxDraws = 1000;

 private:
  struct Draws;

  Eigen::Index component_at(double share) const noexcept;
  bool draw(Draws& draws) const noexcept;
  bool draw_inside(Draws& draws) const noexcept;

  Eigen::Index dimension_;
  Eigen::ArrayXd cumulative_weights_;
  std::vector<Eigen::Index> guide_;  // of K equal parts of all weight: the first component there
  // Rows come in blocks of four, padded by joints that are 0 and have no limits.
  Eigen::ArrayXXd means_;    // rows x K
  Eigen::ArrayXXd factors_;  // 4 n x K, or 4 n x 1 if shared: by block of rows, its columns
  Eigen::ArrayXd lower_, upper_;
};

}  // namespace kinship::mixture
