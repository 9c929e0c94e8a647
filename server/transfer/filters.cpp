#include "server/transfer/filters.hpp"

#include <algorithm>

namespace kinship::transfer {

Eigen::Index CountedFilters::keep_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  const Eigen::Index count = qs.cols();
  if (count == 0 || (!filters_.self && !filters_.scene))
    return count;
  const Eigen::Index apart = filters_.self ? filters_.self(qs) : count;
  const Eigen::Index kept =
      filters_.scene && apart > 0 ? filters_.scene(qs.leftCols(apart)) : apart;
  checks_ += static_cast<std::uint64_t>(std::min(kept + 1, count));
  if (kept < apart)
    ++scene_collisions_;
  else if (apart < count)
    ++self_collisions_;
  return kept;
}

Eigen::MatrixXd passed(Eigen::MatrixXd configurations, CountedFilters& filters) {
  const Eigen::Index count = configurations.cols();
  Eigen::Index kept = 0;
  for (Eigen::Index next = 0; next < count; ++next) {  // past the one that was left out
    const Eigen::Index more = filters.keep_ahead(configurations.rightCols(count - next));
    for (Eigen::Index i = 0; i < more; ++i, ++kept, ++next)
      if (kept != next)
        configurations.col(kept) = configurations.col(next);
  }
  configurations.conservativeResize(Eigen::NoChange, kept);
  return configurations;
}

}  // namespace kinship::transfer
