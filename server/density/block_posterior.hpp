#pragma once

#include <vector>

#include "server/density/aligned_numbers.hpp"
#include "server/density/block_kernels.hpp"
#include "server/density/block_points.hpp"
#include "server/density/packed_mixture.hpp"

namespace kinship::density {

/// What a mixture says about the points of one block at a time. Memory of one thread's work.
class BlockPosterior {
 public:
  /// \param mixture, kernels  outlive it.
  BlockPosterior(const PackedMixture& mixture, const BlockKernels& kernels, bool prune);

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

  /// What lies so far below the largest term of a point is nothing beside it, nats.
  static constexpr double kNegligible = 42;

 private:
  void choose_candidates(const BlockPoints& points, int block);
  double upper_bound(int component) const { return bounds_[static_cast<std::size_t>(component)]; }

  const PackedMixture& mixture_;
  const BlockKernels& kernels_;
  const bool prune_;
  AlignedNumbers bounds_;  // 3 x stride: upper, lower, at the centre
  AlignedNumbers terms_;   // K x kBlockPoints
  std::vector<int> candidates_;
  double best_lower_bound_ = 0;
  int count_ = 0;
  std::vector<double> peaks_;
  alignas(64) double largest_[kBlockPoints] = {};
  alignas(64) double log_densities_[kBlockPoints] = {};
};

}  // namespace kinship::density
