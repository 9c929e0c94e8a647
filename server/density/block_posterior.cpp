#include "server/density/block_posterior.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace kinship::density {

BlockPosterior::BlockPosterior(const PackedMixture& mixture, const BlockKernels& kernels,
                               bool prune)
    : mixture_(mixture), kernels_(kernels), prune_(prune) {
  const auto size = static_cast<std::size_t>(mixture.size());
  bounds_.resize(3 * static_cast<std::size_t>(mixture.stride()));
  terms_.resize(size * kBlockPoints);
  peaks_.resize(size);
  candidates_.reserve(size);
}

/// Those that may count somewhere in the block's box, the likeliest first.
void BlockPosterior::choose_candidates(const BlockPoints& points, int block) {
  kernels_.bounds(mixture_.dimension(), mixture_.interleaved(), mixture_.stride(),
                  points.centre(block), points.half_widths(block), bounds_.data());
  const double* lower = bounds_.data() + mixture_.stride();
  const double* at_centre = lower + mixture_.stride();
  best_lower_bound_ = *std::max_element(lower, lower + mixture_.size());
  for (int k = 0; k < mixture_.size(); ++k)
    if (upper_bound(k) >= best_lower_bound_ - kNegligible)
      candidates_.push_back(k);
  std::sort(candidates_.begin(), candidates_.end(), [at_centre](int a, int b) {
    return at_centre[a] != at_centre[b] ? at_centre[a] > at_centre[b] : a < b;
  });
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

}  // namespace kinship::density
