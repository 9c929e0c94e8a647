#include "proto/json/admin_rows_json.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::json::admin_rows_json_test {
namespace {

Digest digest_of(std::uint8_t byte) {
  Digest digest;
  digest.bytes.fill(byte);
  return digest;
}

Distribution fitted() {
  Distribution distribution;
  distribution.id = digest_of(1);
  distribution.task = "bin_to_shelf";
  distribution.profile = "default";
  distribution.limits = (Eigen::Matrix2Xd(2, 1) << -1, 1).finished();
  Eigen::MatrixXd one(1, 1);
  one << 1;
  distribution.mixture = Mixture(Eigen::VectorXd::Ones(1), one, {one});
  return distribution;
}

TEST(AdminRowsJson, ExplanationIsReadBackWithAndWithoutItsMixture) {
  Explanation explanation;
  explanation.distribution = fitted();
  explanation.experience = {{digest_of(4), "panda", 60, 12}, {digest_of(5), "iiwa14", 40, 11}};
  explanation.behind = true;
  explanation.next_fit = "at the next fetch: 12 new paths";
  std::string text = to_json(explanation);
  EXPECT_EQ(to_json(row_from_json<Explanation>(text).value_or_throw()), text);

  explanation.distribution.mixture.reset();
  text = to_json(explanation);
  const auto back = row_from_json<Explanation>(text);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_json(*back), text);
  EXPECT_EQ(back->experience[1].label, "iiwa14");
}

TEST(AdminRowsJson, RehearsalOfAnExplanationIsReadBackAndMayBeMissing) {
  Explanation explanation;
  explanation.distribution = fitted();
  std::string text = to_json(explanation);
  const std::string none = R"(,"rehearsal":null)";
  ASSERT_NE(text.find(none), std::string::npos) << text;
  EXPECT_FALSE(row_from_json<Explanation>(text).value_or_throw().rehearsal);
  text.erase(text.find(none), none.size());
  EXPECT_FALSE(row_from_json<Explanation>(text).value_or_throw().rehearsal);

  explanation.rehearsal = Rehearsal{.guide = Guide::RetreatWays,
                                    .is_complete = true,
                                    .queries = 100,
                                    .left_out = 3,
                                    .processor_time_s = 74.25,
                                    .costs = {{Guide::None, 400, 380, 1552.5, 900, 0.25}},
                                    .message = "why"};
  text = to_json(explanation);
  EXPECT_TRUE(text.ends_with(
      R"("rehearsal":{"guide":"retreat+ways","is_complete":true,"queries":100,"left_out":3,)"
      R"("processor_time_s":74.25,"costs":[{"guide":"none","plans":400,"solved":380,)"
      R"("mean_checks":1552.5,"median_checks":900.0,"mean_time_s":0.25}],"message":"why"}})"))
      << text;
  EXPECT_EQ(row_from_json<Explanation>(text).value_or_throw().rehearsal, explanation.rehearsal);
  text.replace(text.find("retreat+ways"), 12, "luck");
  EXPECT_TRUE(row_from_json<Explanation>(text).error().message.starts_with("guide: 'luck'"))
      << row_from_json<Explanation>(text).error().message;
}

}  // namespace
}  // namespace kinship::json::admin_rows_json_test
