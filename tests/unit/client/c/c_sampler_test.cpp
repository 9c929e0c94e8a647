// What kinship_sampler_fill writes where.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "client/c/handles.hpp"
#include "client/c/kinship.h"

namespace kinship::c_sampler_test {
namespace {

constexpr size_t kDof = 3, kCount = 50, kStride = 8, kArrayStride = 64;

constexpr double kLimit = 0.1;  // the nearest float is beyond it

/// A mixture of three joints, the second of which hardly moves and has its limit in the middle.
Distribution cut_distribution() {
  Distribution distribution;
  const Eigen::Matrix3d covariance = Eigen::Vector3d(0.01, 1e-18, 0.01).asDiagonal();
  distribution.mixture.emplace(Eigen::VectorXd::Ones(1), Eigen::Vector3d(0, kLimit, 2),
                               std::vector<Eigen::MatrixXd>{covariance});
  distribution.limits.resize(2, 3);
  distribution.limits << -3, -3, -3, 3, kLimit, 3;
  return distribution;
}

class CSampler : public testing::Test {
 protected:
  CSampler() {
    const kinship_distribution distribution{
        std::make_shared<const Distribution>(cut_distribution())};
    EXPECT_EQ(kinship_sampler_create(&distribution, &sampler_), KINSHIP_OK);
  }
  void TearDown() override { kinship_sampler_free(sampler_); }

  kinship_sampler* sampler_ = nullptr;
};

TEST_F(CSampler, RowsArePaddedWithZerosAndArraysHoldTheSameNumbers) {
  std::vector<double> rows(kCount * kStride, 77), arrays(kDof * kArrayStride, 77);
  ASSERT_EQ(kinship_sampler_fill(sampler_, rows.data(), kCount, kStride, KINSHIP_ROWS, 5),
            KINSHIP_OK);
  ASSERT_EQ(kinship_sampler_fill(sampler_, arrays.data(), kCount, kArrayStride, KINSHIP_ARRAYS, 5),
            KINSHIP_OK);
  for (size_t i = 0; i < kCount; ++i) {
    for (size_t j = 0; j < kDof; ++j)
      EXPECT_EQ(rows[i * kStride + j], arrays[j * kArrayStride + i]);
    for (size_t j = kDof; j < kStride; ++j)
      EXPECT_EQ(rows[i * kStride + j], 0);
  }
  for (size_t j = 0; j < kDof; ++j)
    for (size_t i = kCount; i < kArrayStride; ++i)
      EXPECT_EQ(arrays[j * kArrayStride + i], 77) << "written beyond the count";
}

TEST_F(CSampler, EqualSeedsGiveEqualNumbersAndOthersOthers) {
  std::vector<double> first(kCount * kDof), again(kCount * kDof), other(kCount * kDof);
  kinship_sampler_fill(sampler_, first.data(), kCount, kDof, KINSHIP_ROWS, 5);
  kinship_sampler_fill(sampler_, again.data(), kCount, kDof, KINSHIP_ROWS, 5);
  kinship_sampler_fill(sampler_, other.data(), kCount, kDof, KINSHIP_ROWS, 6);
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

TEST_F(CSampler, FloatsAreTheSameNumbersRoundedAndWithinTheLimits) {
  constexpr size_t kMany = 20'000;
  std::vector<double> doubles(kMany * kDof);
  std::vector<float> floats(kMany * kDof);
  kinship_sampler_fill(sampler_, doubles.data(), kMany, kDof, KINSHIP_ROWS, 5);
  kinship_sampler_fill_float(sampler_, floats.data(), kMany, kDof, KINSHIP_ROWS, 5);
  for (size_t i = 0; i < doubles.size(); ++i)
    EXPECT_NEAR(floats[i], doubles[i], 1e-6);
  for (size_t i = 0; i < kMany; ++i)
    EXPECT_LE(static_cast<double>(floats[i * kDof + 1]), kLimit);
}

TEST_F(CSampler, AStrideThatIsTooShortIsRefused) {
  std::vector<double> room(kCount * kDof);
  EXPECT_EQ(kinship_sampler_fill(sampler_, room.data(), kCount, kDof - 1, KINSHIP_ROWS, 5),
            KINSHIP_INVALID_INPUT);
  EXPECT_STREQ(kinship_error_text(), "stride is 2, must be at least 3");
  EXPECT_EQ(kinship_sampler_fill(sampler_, room.data(), kCount, kCount - 1, KINSHIP_ARRAYS, 5),
            KINSHIP_INVALID_INPUT);
  EXPECT_EQ(kinship_sampler_fill(sampler_, room.data(), kCount, kStride,
                                 static_cast<kinship_layout>(2), 5),
            KINSHIP_INVALID_INPUT);
}

}  // namespace
}  // namespace kinship::c_sampler_test
