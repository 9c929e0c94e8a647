#include "server/density/packed_mixture.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "proto/mixture/cholesky.hpp"
#include "server/density/block_kernels.hpp"

namespace kinship::density {
namespace {

constexpr int kLaneMultiple = 8;
/// Instead of the logarithm of 0: finite, so that differences are numbers.
constexpr double kLeastLogWeight = -1e100;

void pack(double weight, const Eigen::MatrixXd& factor, const Eigen::VectorXd& mean, double* out) {
  const Eigen::Index dimension = factor.rows();
  const Eigen::MatrixXd whitening =
      factor.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(dimension, dimension)) *
      std::numbers::sqrt2 / 2;
  const Eigen::VectorXd offset = whitening.triangularView<Eigen::Lower>() * mean;
  *out++ = std::max(std::log(weight), kLeastLogWeight) - factor.diagonal().array().log().sum() -
           0.5 * static_cast<double>(dimension) * std::log(2 * std::numbers::pi);
  for (Eigen::Index row = 0; row < dimension; ++row) {
    *out++ = offset[row];
    for (Eigen::Index column = 0; column <= row; ++column)
      *out++ = whitening(row, column);
  }
}

}  // namespace

PackedMixture::PackedMixture(const Mixture& mixture, const Eigen::VectorXd& offset)
    : size_(static_cast<int>(mixture.size())),
      stride_((size_ + kLaneMultiple - 1) / kLaneMultiple * kLaneMultiple),
      dimension_(static_cast<int>(mixture.dimension())),
      stride_of_component_(packed_size(dimension_)) {
  one_by_one_.resize(static_cast<std::size_t>(size_ * stride_of_component_));
  interleaved_.resize(static_cast<std::size_t>(stride_ * stride_of_component_));
  const std::vector<Eigen::MatrixXd> factors = mixture::cholesky_factors(mixture);
  for (int k = 0; k < size_; ++k)
    pack(mixture.weights()[k], factors[mixture.covariance_index(k)],
         mixture.means().col(k) - offset, one_by_one_.data() + k * stride_of_component_);
  for (int k = 0; k < stride_; ++k)
    for (std::ptrdiff_t entry = 0; entry < stride_of_component_; ++entry)
      interleaved_[static_cast<std::size_t>(entry * stride_ + k)] =
          component(k < size_ ? k : 0)[entry];
}

}  // namespace kinship::density
