#include "server/density/simd_kernels.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "server/density/instruction_set.hpp"

namespace kinship::density::simd_kernels_test {
namespace {

constexpr std::uint64_t kSeed = 17;
using Block = std::array<double, kBlockPoints>;

/// Every instruction set of this machine, and every way in which the kernels treat dimensions.
class Kernels : public testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    kernels_ = find_simd_kernels(GetParam());
    if (kernels_ == nullptr)
      GTEST_SKIP() << "this machine does not have it";
  }
  Eigen::MatrixXd random(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal_(generator_); });
  }

  const SimdKernels* kernels_ = nullptr;
  std::mt19937_64 generator_{kSeed};
  std::normal_distribution<double> normal_;
};

constexpr std::array kDimensions = {1, 2, 3, 4, 5, 6, 7, 8, 9, 13, 32};

/// The log density of a packed component as simd_kernels.hpp defines it.
double log_term(const Eigen::VectorXd& component, const Eigen::VectorXd& point) {
  double term = component[0];
  Eigen::Index entry = 1;
  for (Eigen::Index i = 0; i < point.size(); ++i) {
    double y = -component[entry++];
    for (Eigen::Index j = 0; j <= i; ++j)
      y += component[entry++] * point[j];
    term -= y * y;
  }
  return term;
}

TEST_P(Kernels, LogTermsAndTheLargestOfThem) {
  for (const int d : kDimensions) {
    const Eigen::MatrixXd points = random(kBlockPoints, d);
    const Eigen::VectorXd component = random(packed_size(d), 1);
    Block terms{}, largest{}, before{};
    for (double& value : before)
      value = -10 * std::abs(normal_(generator_));
    largest = before;
    double least = 0;
    const double excess = kernels_->log_terms(d, points.data(), component.data(), terms.data(),
                                              largest.data(), &least);
    double expected_excess = -1e300, expected_least = 1e300;
    for (std::size_t i = 0; i < terms.size(); ++i) {
      const double expected =
          log_term(component, points.row(static_cast<Eigen::Index>(i)).transpose());
      EXPECT_NEAR(terms[i], expected, 1e-12 * std::abs(expected) + 1e-12) << "d " << d;
      EXPECT_EQ(largest[i], std::max(before[i], terms[i]));
      expected_excess = std::max(expected_excess, terms[i] - before[i]);
      expected_least = std::min(expected_least, largest[i]);
    }
    EXPECT_EQ(excess, expected_excess);
    EXPECT_EQ(least, expected_least);
  }
}

TEST_P(Kernels, BoundsHoldEverywhereInTheBox) {
  constexpr int kStride = 16;
  for (const int d : kDimensions) {
    const Eigen::MatrixXd components = random(kStride, packed_size(d));  // number by number
    const Eigen::VectorXd centre = random(d, 1);
    const Eigen::VectorXd half = random(d, 1).cwiseAbs();
    std::vector<double> bounds(3 * kStride);
    kernels_->bounds(d, components.data(), kStride, centre.data(), half.data(), bounds.data());
    for (std::size_t k = 0; k < kStride; ++k) {
      const Eigen::VectorXd component = components.row(static_cast<Eigen::Index>(k)).transpose();
      const double slack = 1e-10 * std::abs(bounds[kStride + k]);
      for (int i = 0; i < 50; ++i) {
        const Eigen::VectorXd corner =
            centre + half.cwiseProduct(random(d, 1).cwiseMax(-1).cwiseMin(1));
        const double term = log_term(component, corner);
        EXPECT_LE(term, bounds[k] + slack);
        EXPECT_GE(term, bounds[kStride + k] - slack);
      }
      EXPECT_NEAR(bounds[2 * kStride + k], log_term(component, centre), slack);
    }
  }
}

TEST_P(Kernels, ResponsibilitiesAreExponentialsOfWhichEachPointHasASumOfOne) {
  constexpr int kCount = 5;
  Eigen::MatrixXd terms = 3 * random(kBlockPoints, kCount);
  terms.row(3).array() -= 1e9;  // far from every component
  terms(4, 2) = -5000;          // and from one of them
  terms.row(5).setZero();       // in the middle
  const Eigen::MatrixXd before = terms;
  const Eigen::VectorXd largest = terms.rowwise().maxCoeff();
  Block log_densities{};
  std::array<double, kCount> peaks{};
  kernels_->responsibilities(kCount, terms.data(), largest.data(), peaks.data(),
                             log_densities.data());
  const Eigen::ArrayXXd shares = (before.colwise() - largest).array().exp();
  const Eigen::ArrayXd sums = shares.rowwise().sum();
  for (Eigen::Index i = 0; i < kBlockPoints; ++i) {
    EXPECT_NEAR(terms.row(i).sum(), 1, 1e-14);
    EXPECT_NEAR(log_densities[static_cast<std::size_t>(i)], largest[i] + std::log(sums[i]),
                1e-15 * std::abs(largest[i]) + 4e-16);
    for (Eigen::Index k = 0; k < kCount; ++k)
      EXPECT_NEAR(terms(i, k), shares(i, k) / sums[i], 1e-15);
  }
  for (std::size_t k = 0; k < kCount; ++k)
    EXPECT_EQ(peaks[k], terms.col(static_cast<Eigen::Index>(k)).maxCoeff());
}

TEST_P(Kernels, LogarithmOfManyEqualComponents) {
  for (const int count : {1, 2, 3, 1000}) {
    std::vector<double> terms(static_cast<std::size_t>(count * kBlockPoints), 0.0);
    std::vector<double> peaks(static_cast<std::size_t>(count));
    Block largest{}, log_densities{};
    kernels_->responsibilities(count, terms.data(), largest.data(), peaks.data(),
                               log_densities.data());
    EXPECT_NEAR(log_densities[77], std::log(static_cast<double>(count)), 2e-15);
    EXPECT_NEAR(peaks[0], 1.0 / count, 1e-16);
  }
}

TEST_P(Kernels, MomentsAreTheSumsWrittenOut) {
  for (const int d : kDimensions) {
    const Eigen::MatrixXd points = random(kBlockPoints, d);
    const Eigen::VectorXd responsibilities = random(kBlockPoints, 1).cwiseAbs();
    const Eigen::VectorXd weights = random(kBlockPoints, 1).cwiseAbs();
    Eigen::VectorXd sums = Eigen::VectorXd::Ones(packed_size(d));
    kernels_->add_moments(d, points.data(), responsibilities.data(), weights.data(), sums.data());
    const Eigen::VectorXd masses = responsibilities.cwiseProduct(weights);
    Eigen::Index entry = 0;
    EXPECT_NEAR(sums[entry++], 1 + masses.sum(), 1e-11);
    for (int i = 0; i < d; ++i)
      EXPECT_NEAR(sums[entry++], 1 + masses.dot(points.col(i)), 1e-11) << "d " << d;
    for (int i = 0; i < d; ++i)
      for (int j = i; j < d; ++j)
        EXPECT_NEAR(sums[entry++], 1 + masses.dot(points.col(i).cwiseProduct(points.col(j))), 1e-11)
            << "d " << d;
  }
}

TEST_P(Kernels, DistancesToCentres) {
  for (const int d : kDimensions) {
    const Eigen::MatrixXd points = random(kBlockPoints, d);
    const Eigen::VectorXd weights = random(kBlockPoints, 1).cwiseAbs();
    const Eigen::MatrixXd centres = random(d, 6);
    const Eigen::VectorXd before = d * random(kBlockPoints, 1).cwiseAbs();
    Block after{}, chosen{};
    const double sum = kernels_->nearer(d, points.data(), weights.data(), centres.data(),
                                        before.data(), after.data());
    kernels_->nearest(d, points.data(), 6, centres.data(), chosen.data());
    double expected_sum = 0;
    for (Eigen::Index i = 0; i < kBlockPoints; ++i) {
      const Eigen::VectorXd squared =
          (centres.colwise() - points.row(i).transpose()).colwise().squaredNorm().transpose();
      Eigen::Index nearest = 0;
      squared.minCoeff(&nearest);
      const auto point = static_cast<std::size_t>(i);
      EXPECT_EQ(chosen[point], static_cast<double>(nearest));
      EXPECT_NEAR(after[point], std::min(before[i], squared[0]), 1e-12);
      expected_sum += weights[i] * after[point];
    }
    EXPECT_NEAR(sum, expected_sum, 1e-10);
  }
}

INSTANTIATE_TEST_SUITE_P(InstructionSets, Kernels,
                         testing::Values(InstructionSet::Baseline, InstructionSet::Avx2,
                                         InstructionSet::Avx512));

}  // namespace
}  // namespace kinship::density::simd_kernels_test
