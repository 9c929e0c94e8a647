#pragma once

#include <Eigen/Core>
#include <stop_token>

#include "server/density/aligned_numbers.hpp"
#include "server/density/distinct_points.hpp"
#include "server/density/simd_kernels.hpp"

namespace kinship::density {

/// Points in the layout of the kernels: blocks of kBlockPoints neighbours, joint by joint, each
/// with the box that holds it. Relative to an offset, so that squares keep their digits. The last
/// block is filled up with its last point, at weight 0. Immutable: threads may share it.
class BlockPoints {
 public:
  /// \param configurations  d x N; only the columns in `distinct` are used, at least one.
  /// \param offset          d, becomes the origin.
  /// \throws Stopped.
  BlockPoints(const Eigen::Ref<const Eigen::MatrixXd>& configurations, DistinctPoints distinct,
              Eigen::VectorXd offset, const std::stop_token& stop = {});

  int dimension() const noexcept { return static_cast<int>(offset_.size()); }
  Eigen::Index size() const noexcept { return size_; }  ///< number of points
  int blocks() const noexcept { return static_cast<int>(centres_.cols()); }
  const Eigen::VectorXd& offset() const noexcept { return offset_; }
  double total_weight() const noexcept { return total_weight_; }

  /// d rows of kBlockPoints numbers: row i holds joint i.
  const double* points(int block) const noexcept {
    return points_.data() + static_cast<std::ptrdiff_t>(block) * dimension() * kBlockPoints;
  }
  const double* weights(int block) const noexcept {  ///< kBlockPoints
    return weights_.data() + static_cast<std::ptrdiff_t>(block) * kBlockPoints;
  }
  const double* centre(int block) const noexcept { return centres_.col(block).data(); }
  const double* half_widths(int block) const noexcept { return half_widths_.col(block).data(); }

  Eigen::VectorXd point(Eigen::Index index) const;  ///< in block order, relative to the offset
  double weight(Eigen::Index index) const { return weights_[static_cast<std::size_t>(index)]; }

 private:
  Eigen::VectorXd offset_;
  Eigen::Index size_;
  double total_weight_ = 0;
  AlignedNumbers points_;
  AlignedNumbers weights_;
  Eigen::MatrixXd centres_, half_widths_;  // d x blocks, of the boxes
};

/// The weighted mean of distinct points, d.
Eigen::VectorXd mean_of(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                        const DistinctPoints& distinct);

/// `count` of the points, or all if they are fewer, spread evenly over the block order, which is a
/// fair sample of space; the mean of their weights is 1.
BlockPoints thinned(const BlockPoints& points, Eigen::Index count);

}  // namespace kinship::density
