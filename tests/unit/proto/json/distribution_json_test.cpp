#include "proto/json/distribution_json.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/types/limits.hpp"

namespace kinship::json::distribution_json_test {
namespace {

Distribution two_components() {
  Distribution distribution;
  distribution.id.bytes.fill(0x1a);
  distribution.revision = 3;
  distribution.task = "bin_to_shelf";
  distribution.profile = std::string(kMaxProfileBytes, 'p');
  distribution.engines = "transfer 1, density 1";
  distribution.configurations = 400;
  Eigen::MatrixXd means(2, 2);
  means << 0.1, 0.3, 0.2, 0.4;
  Eigen::Matrix2d covariance;
  covariance << 2, 0.5, 0.5, 1;
  distribution.mixture =
      Mixture(Eigen::Vector2d(0.25, 0.75), means, {covariance, Eigen::Matrix2d::Identity()});
  distribution.limits.resize(2, 2);
  distribution.limits << -1, -2, 1, 2;
  distribution.advice.recommended_share = 0.9;
  return distribution;
}

std::string changed(std::string_view from, std::string_view to) {
  std::string text = to_json(two_components());
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

std::string message_of(const std::string& text) {
  const auto result = distribution_from_json(text);
  return result ? "accepted" : result.error().message;
}

Digest digest_of(std::uint8_t byte) {
  Digest digest;
  digest.bytes.fill(byte);
  return digest;
}

Distribution with_details() {
  Distribution distribution = two_components();
  distribution.selection = {
      .sources = {digest_of(1), digest_of(2)}, .weighting = Weighting::Paths, .since_ms = 99};
  Source source;
  source.robot = digest_of(1);
  source.relation = Relation::SameArm;
  source.mass = 0.625;
  distribution.sources = {source};
  distribution.advice.guided =
      ModeEvidence{.attempts = 20, .solved = 18, .checks_per_solution = 45};
  distribution.advice.guided_share = 0.5;
  distribution.advice.recent = {{SamplingMode::Control, true, 70, 19},
                                {SamplingMode::Guided, false, 45, 0}};
  return distribution;
}

TEST(DistributionJson, DetailsOutsideTheirRangeAreRefused) {
  const auto message_with = [](const std::string& from, const std::string& to) {
    std::string text = to_json(with_details());
    EXPECT_NE(text.find(from), std::string::npos) << from;
    return message_of(text.replace(text.find(from), from.size(), to));
  };
  EXPECT_EQ(message_with("\"since_ms\":99", "\"since_ms\":-1"),
            "selection.since_ms: -1 is negative");
  EXPECT_EQ(message_with(digest_of(2).hex(), digest_of(1).hex()),
            "selection: sources must be ascending and distinct");
  EXPECT_EQ(message_with("\"weighting\":\"paths\"", "\"weighting\":\"age\""),
            "weighting: 'age' is not one of sources, paths");
  EXPECT_EQ(message_with("\"mass\":0.625", "\"mass\":1.5"), "sources[0].mass: 1.5 exceeds 1");
  EXPECT_EQ(message_with("\"same_arm\"", "\"cousin\""),
            "relation: 'cousin' is not one of other, same_arm, identical");
  EXPECT_EQ(message_with("\"solved\":18", "\"solved\":21"), "guided.solved: 21 exceeds 20");
  EXPECT_EQ(message_with("\"sampling_mode\":\"control\"", "\"sampling_mode\":\"uniform\""),
            "recent[0].sampling_mode: must be guided or control");
  EXPECT_EQ(message_with("\"age\":0", "\"age\":20"),
            "recent[1]: is older than the one before, must be oldest first");
}

TEST(DistributionJson, ThinIsServedWithItsMixture) {
  Distribution thin = two_components();
  thin.state = DistributionState::Thin;
  const auto back = distribution_from_json(to_json(thin));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->state, DistributionState::Thin);
  EXPECT_EQ(back->mixture->size(), thin.mixture->size());
}

TEST(DistributionJson, MixtureThatIsNoneIsRefused) {
  EXPECT_EQ(message_of(changed("[0.25,0.75]", "[0.25,0.85]")),
            "weights, means, covariances: Mixture: weights must be >= 0 with sum 1, means finite");
  EXPECT_EQ(message_of(changed("[0.25,0.75]", "[1.0]")),
            "weights, means, covariances: Mixture: need K >= 1 weights, d x K means, K covariances "
            "or one");
  EXPECT_EQ(message_of(changed("[2.0,0.5]", "[2.0,0.6]")),
            "weights, means, covariances: Mixture: covariances must be symmetric");
  EXPECT_EQ(message_of(changed("[0.25,0.75]", "null")), "weights: must be an array, is null");
}

TEST(DistributionJson, LimitsMustFitTheMixture) {
  EXPECT_EQ(message_of(changed("[[-1.0,1.0],[-2.0,2.0]]", "[[-1,1]]")),
            "limits: 1 joints, means have 2");
  EXPECT_EQ(message_of(changed("[[-1.0,1.0],[-2.0,2.0]]", "[[-1,1],[2,-2]]")),
            "limits: joint 1 has lower limit 2.000000 above upper -2.000000");
  EXPECT_EQ(message_of(changed("[[-1.0,1.0],[-2.0,2.0]]", "[[1],[2]]")),
            "limits: each joint needs [lower, upper]");
}

TEST(DistributionJson, StatesAndSharesOutsideTheirRangeAreRefused) {
  EXPECT_EQ(message_of(changed("\"ready\"", "\"stale\"")),
            "state: 'stale' is not one of ready, failed, thin");
  EXPECT_EQ(message_of(changed("\"ready\"", "\"failed\"")),
            "weights: must be null if state is 'failed'");
  EXPECT_EQ(message_of(changed("\"recommended_share\":0.9", "\"recommended_share\":2")),
            "recommended_share: 2 exceeds 1");
  EXPECT_EQ(message_of(changed("\"cuts\":null", "\"cuts\":[0]")), "cuts: 1 entries for 2 joints");
  EXPECT_EQ(message_of(changed("\"k_curve\":null", R"("k_curve":[{"K":0,"score":1}])")),
            "k_curve[0]: K is not between 1 and 1024");
  EXPECT_EQ(message_of(changed("\"k_curve\":null",
                               R"("k_curve":[{"K":20,"score":1},{"K":20,"score":0}])")),
            "k_curve[1]: K does not fall");
}

}  // namespace
}  // namespace kinship::json::distribution_json_test
