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

TEST(AdminRowsJson, JobIsReadBack) {
  Job job{.id = "0a1b2c3d",
          .verb = "backup",
          .argument = "/var/backups/fleet.db",
          .state = JobState::Running,
          .progress = 0.25,
          .message = "page 3 of 12",
          .rows = 7,
          .started_ms = 1000,
          .ended_ms = 2000};
  const std::string text = to_json(job);
  EXPECT_EQ(text, R"({"id":"0a1b2c3d","verb":"backup","argument":"/var/backups/fleet.db",)"
                  R"("state":"running","progress":0.25,"message":"page 3 of 12","rows":7,)"
                  R"("started_ms":1000,"ended_ms":2000})");
  EXPECT_EQ(to_json(row_from_json<Job>(text).value_or_throw()), text);
}

TEST(AdminRowsJson, JobWithAnImpossibleMemberIsRefusedByName) {
  const std::string text = to_json(Job{});
  const auto message_with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    return row_from_json<Job>(changed).error().message;
  };
  EXPECT_EQ(message_with(R"("queued")", R"("asleep")"),
            "state: 'asleep' is not one of queued, running, done, failed, cancelled");
  EXPECT_EQ(message_with(R"("progress":0.0)", R"("progress":1.5)"), "progress: 1.5 exceeds 1");
  EXPECT_EQ(message_with(R"("rows":0)", R"("rows":-1)"),
            "rows: must be an integer from 0 to 2^64 - 1");
}

TEST(AdminRowsJson, RetirementIsReadBack) {
  const std::string text = to_json(Retirement{"bin_to_shelf", 12, {digest_of(1), digest_of(2)}});
  EXPECT_EQ(text, R"({"task":"bin_to_shelf","paths":12,"robots":[")" + digest_of(1).hex() +
                      R"(",")" + digest_of(2).hex() + R"("]})");
  EXPECT_EQ(to_json(row_from_json<Retirement>(text).value_or_throw()), text);
}

TEST(AdminRowsJson, ARobotRemovalIsReadBack) {
  const std::string text = to_json(RobotRemoval{digest_of(1), "cell1", 12, 20, 3, true});
  EXPECT_EQ(text, R"({"robot":")" + digest_of(1).hex() +
                      R"(","label":"cell1","paths":12,"attempts":20,"distributions":3,)"
                      R"("is_deleted":true})");
  EXPECT_EQ(to_json(row_from_json<RobotRemoval>(text).value_or_throw()), text);
}

TEST(AdminRowsJson, EvictionIsReadBack) {
  const std::string text = to_json(Eviction{digest_of(3)});
  EXPECT_EQ(text, R"({"evicted":")" + digest_of(3).hex() + R"("})");
  EXPECT_EQ(row_from_json<Eviction>(text).value_or_throw().id, digest_of(3));
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
                                    .costs = {{Guide::None, 400, 380, 1552.5, 900}},
                                    .message = "why"};
  text = to_json(explanation);
  EXPECT_TRUE(text.ends_with(
      R"("rehearsal":{"guide":"retreat+ways","is_complete":true,"queries":100,"left_out":3,)"
      R"("processor_time_s":74.25,"costs":[{"guide":"none","plans":400,"solved":380,)"
      R"("mean_checks":1552.5,"median_checks":900.0}],"message":"why"}})"))
      << text;
  EXPECT_EQ(row_from_json<Explanation>(text).value_or_throw().rehearsal, explanation.rehearsal);
  text.replace(text.find("retreat+ways"), 12, "luck");
  EXPECT_TRUE(row_from_json<Explanation>(text).error().message.starts_with("guide: 'luck'"))
      << row_from_json<Explanation>(text).error().message;
}

TEST(AdminRowsJson, RefusalInsideAnExplanationNamesThePlace) {
  Explanation explanation;
  explanation.distribution = fitted();
  std::string text = to_json(explanation);
  const std::string member = R"("recommended_share":0.0)";
  text.replace(text.find(member), member.size(), R"("recommended_share":2)");
  EXPECT_EQ(row_from_json<Explanation>(text).error().message,
            "distribution.recommended_share: 2 exceeds 1");
}

}  // namespace
}  // namespace kinship::json::admin_rows_json_test
