#pragma once

#include <Eigen/Core>

namespace kinship::test {

/// A filter of configurations that asks `keeps` about each by itself.
template <typename Keeps>
auto one_by_one(Keeps keeps) {
  return [keeps](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    Eigen::Index kept = 0;
    while (kept < qs.cols() && keeps(qs.col(kept)))
      ++kept;
    return kept;
  };
}

}  // namespace kinship::test
