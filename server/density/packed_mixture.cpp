#include "server/density/packed_mixture.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "proto/mixture/cholesky.hpp"
#include "proto/types/failure.hpp"
#include "server/density/simd_kernels.hpp"

namespace kinship::density {
namespace {

constexpr int kLaneMultiple = 8;
/// Instead of the logarithm of 0: finite, so that differences are numbers.
constexpr double kMinLogWeight = -1e100;
/// Of the kernels' input: squares of sums of products with points, and sums of them, are finite.
constexpr double kLargestNumber = 1e120;

/// The part that components of one covariance share.
struct Whitening {
  explicit Whitening(const Eigen::MatrixXd& factor)
      : matrix(factor.triangularView<Eigen::Lower>().solve(
                   Eigen::MatrixXd::Identity(factor.rows(), factor.rows())) *
               std::numbers::sqrt2 / 2),
        log_scale(-factor.diagonal().array().log().sum() -
                  0.5 * static_cast<double>(factor.rows()) * std::log(2 * std::numbers::pi)) {}

  Eigen::MatrixXd matrix;  // d x d, lower
  double log_scale;
};

void pack(double weight, const Whitening& whitening, const Eigen::VectorXd& mean, double* out) {
  const double* const matrix = whitening.matrix.data();
  const Eigen::Index dimension = mean.size();
  *out++ = std::max(std::log(weight), kMinLogWeight) + whitening.log_scale;
  for (Eigen::Index row = 0; row < dimension; ++row) {
    double& offset = *out++ = 0;
    for (Eigen::Index column = 0; column <= row; ++column) {
      const double entry = matrix[column * dimension + row];
      offset += entry * mean.data()[column];
      *out++ = entry;
    }
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
  std::vector<Whitening> whitenings;
  for (const Eigen::MatrixXd& factor : mixture::cholesky_factors(mixture))
    whitenings.emplace_back(factor);
  for (int k = 0; k < size_; ++k) {
    pack(mixture.weights()[k], whitenings[mixture.covariance_index(k)],
         mixture.means().col(k) - offset, one_by_one_.data() + k * stride_of_component_);
    if (!std::all_of(component(k), component(k) + stride_of_component_,
                     [](double number) { return std::abs(number) <= kLargestNumber; }))
      throw Failure(ErrorCode::Internal,
                    "mixture: component " + std::to_string(k) + " is too narrow to compute with");
  }
  for (int k = 0; k < stride_; ++k)
    for (std::ptrdiff_t entry = 0; entry < stride_of_component_; ++entry)
      interleaved_[static_cast<std::size_t>(entry * stride_ + k)] =
          component(k < size_ ? k : 0)[entry];
}

}  // namespace kinship::density
