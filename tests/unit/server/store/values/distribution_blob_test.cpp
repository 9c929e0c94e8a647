#include "server/store/values/distribution_blob.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/store_values.hpp"

namespace kinship::store::distribution_blob_test {
namespace {

Distribution example() { return test::make_distribution(test::id_from<Digest>(1), "shelf", 2); }

/// With `count` components of three joints that share a covariance.
Distribution example_of_kernels(Eigen::Index count) {
  Distribution kernels = example();
  const Eigen::Index dof = kernels.mixture->dimension();
  kernels.mixture = Mixture(Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count)),
                            Eigen::MatrixXd::NullaryExpr(dof, count,
                                                         [](Eigen::Index row, Eigen::Index column) {
                                                           return static_cast<double>(column + row);
                                                         }),
                            {Eigen::MatrixXd::Identity(dof, dof)});
  return kernels;
}

TEST(DistributionBlob, KernelsShareTheirCovariance) {
  const Distribution before = example_of_kernels(4000);
  const std::vector<std::uint8_t> blob = encode_distribution(before);
  const std::optional<Distribution> after = decode_distribution(blob);
  ASSERT_TRUE(after);
  EXPECT_TRUE(after->mixture->shares_covariance());
  EXPECT_EQ(after->mixture->weights(), before.mixture->weights());
  EXPECT_EQ(after->mixture->means(), before.mixture->means());
  EXPECT_EQ(after->mixture->covariances(), before.mixture->covariances());
  EXPECT_FALSE(decode_distribution(encode_distribution(example_of_kernels(4001))));
}

TEST(DistributionBlob, KeepsAFailureWithoutAMixture) {
  Distribution failed = example();
  failed.state = DistributionState::Failed;
  failed.reason = "no pose of 640 is in reach";
  failed.mixture.reset();
  failed.T_task_base.reset();
  failed.held_out_score.reset();
  failed.sources.clear();
  const std::optional<Distribution> after = decode_distribution(encode_distribution(failed));
  ASSERT_TRUE(after);
  EXPECT_EQ(after->state, DistributionState::Failed);
  EXPECT_EQ(after->reason, failed.reason);
  EXPECT_FALSE(after->mixture || after->T_task_base || after->held_out_score);
}

TEST(DistributionBlob, RefusesCutsAndScoresThatNoFitWrites) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Distribution more_cuts_than_joints = example();
  more_cuts_than_joints.cuts.emplace_back(0.5);
  Distribution endless_cut = example();
  endless_cut.cuts[1] = kNan;
  Distribution no_score = example();
  no_score.component_scores[0].score = kNan;
  Distribution no_components = example();
  no_components.component_scores[1].components = 0;
  for (const Distribution& wrong : {more_cuts_than_joints, endless_cut, no_score, no_components})
    EXPECT_FALSE(decode_distribution(encode_distribution(wrong)));
}

TEST(DistributionBlob, RefusesAnotherFormat) {
  std::vector<std::uint8_t> blob = encode_distribution(example());
  for (const std::uint8_t format : {std::uint8_t{0}, std::uint8_t{2}}) {
    blob[0] = format;
    EXPECT_FALSE(decode_distribution(blob)) << int{format};
  }
}

TEST(DistributionBlob, RefusesEveryTruncationAndAnyByteMore) {
  std::vector<std::uint8_t> blob = encode_distribution(example());
  const std::span<const std::uint8_t> all(blob);
  for (std::size_t size = 0; size < blob.size(); ++size)
    EXPECT_FALSE(decode_distribution(all.first(size))) << size;
  blob.push_back(0);
  EXPECT_FALSE(decode_distribution(blob));
}

TEST(DistributionBlob, SurvivesEveryFlippedByteWithoutALargeAllocation) {
  std::vector<std::uint8_t> blob = encode_distribution(example());
  for (std::size_t i = 0; i < blob.size(); ++i) {
    blob[i] ^= 0xFFU;
    static_cast<void>(decode_distribution(blob));  // throws bad_alloc if a size is believed
    blob[i] ^= 0xFFU;
  }
  EXPECT_TRUE(decode_distribution(blob));
}

}  // namespace
}  // namespace kinship::store::distribution_blob_test
