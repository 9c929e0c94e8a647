#pragma once

#include <Eigen/Core>

#include "proto/types/mixture.hpp"
#include "server/density/aligned_numbers.hpp"

namespace kinship::density {

/// The components of a mixture as the kernels read them (simd_kernels.hpp).
class PackedMixture {
 public:
  /// \param offset  d: the origin of the points.
  /// \throws Failure(Internal) if a covariance is not positive definite or below about 1e-240.
  /// Source: Bishop, Pattern Recognition and Machine Learning (2006), eq. 2.43.
  PackedMixture(const Mixture& mixture, const Eigen::VectorXd& offset);

  int size() const noexcept { return size_; }      ///< number of components K
  int stride() const noexcept { return stride_; }  ///< K, rounded up to a multiple of 8
  int dimension() const noexcept { return dimension_; }

  const double* component(int k) const noexcept {
    return one_by_one_.data() + static_cast<std::ptrdiff_t>(k) * stride_of_component_;
  }
  /// Number by number, entry e of component k at e * stride() + k; the padding beyond K repeats the
  /// first component.
  const double* interleaved() const noexcept { return interleaved_.data(); }

 private:
  int size_, stride_, dimension_;
  std::ptrdiff_t stride_of_component_;
  AlignedNumbers one_by_one_;
  AlignedNumbers interleaved_;
};

}  // namespace kinship::density
