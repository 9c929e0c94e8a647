#include "server/access/withheld_sources.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace kinship::access::withheld_sources_test {
namespace {

Digest digest_of(std::uint8_t number) {
  Digest digest;
  digest.bytes.fill(number);
  return digest;
}

Source source_of(std::uint8_t number, const std::string& label) {
  Source source;
  source.robot = digest_of(number);
  source.label = label;
  return source;
}

/// A reply for robot 1 that two others have a part in.
FetchReply reply_of_three() {
  FetchReply reply;
  reply.message = "'teacher': left out, no chain; 'pupil': 3 of 5 paths read";
  reply.distribution.emplace();
  reply.distribution->reason = reply.message;
  reply.distribution->filters = "for 'pupil': solids";
  reply.distribution->sources = {source_of(1, "pupil"), source_of(2, "teacher"),
                                 source_of(3, "pupil_2")};
  reply.experience.emplace();
  for (const std::uint8_t number : {1, 2, 3})
    reply.experience->paths.push_back({digest_of(number), Uuid::random(), {}});
  return reply;
}

Caller for_robots(std::vector<std::string> robots) {
  return {"r1", "r1", AccessRole::Robot, {}, std::move(robots), false};
}

TEST(WithheldSources, OthersLoseLabelAndDigestAndTextsThatNameThem) {
  FetchReply reply = reply_of_three();
  withhold_sources(for_robots({"pupil*"}), digest_of(1), reply);
  const std::vector<Source>& sources = reply.distribution->sources;
  EXPECT_EQ(sources[0].label, "pupil");
  EXPECT_EQ(sources[1].label, kOtherRobot);
  EXPECT_EQ(sources[1].robot, Digest());
  EXPECT_EQ(sources[2].label, "pupil_2");
  EXPECT_EQ(sources[2].robot, digest_of(3));
  EXPECT_EQ(reply.experience->paths[0].source, digest_of(1));
  EXPECT_EQ(reply.experience->paths[1].source, Digest());
  EXPECT_EQ(reply.experience->paths[2].source, digest_of(3));
  EXPECT_EQ(reply.message, "not told: it names robots that the certificate is not for");
  EXPECT_EQ(reply.distribution->reason, reply.message);
  EXPECT_EQ(reply.distribution->filters, "for 'pupil': solids");
}

TEST(WithheldSources, WhatNamesItsOwnRobotsAloneIsTold) {
  FetchReply reply = reply_of_three();
  const std::string message = reply.message;
  withhold_sources(for_robots({"*"}), digest_of(1), reply);
  EXPECT_EQ(reply.message, message);
  EXPECT_EQ(reply.distribution->reason, message);
  EXPECT_EQ(reply.distribution->sources[1].label, "teacher");
}

TEST(WithheldSources, ADistributionAloneIsTreatedAlike) {
  Distribution distribution = *reply_of_three().distribution;
  distribution.robot = digest_of(2);  // the caller may see it, or it would not be asked for
  withhold_sources(for_robots({"pupil"}), distribution);
  EXPECT_EQ(distribution.sources[0].label, "pupil");
  EXPECT_EQ(distribution.sources[1].label, "teacher");
  EXPECT_EQ(distribution.sources[2].label, kOtherRobot);
}

TEST(WithheldSources, WaysAloneAreOfItsRobotOrOfAnother) {
  FetchReply reply = reply_of_three();
  reply.distribution.reset();
  withhold_sources(for_robots({"pupil"}), digest_of(1), reply);
  EXPECT_EQ(reply.experience->paths[0].source, digest_of(1));
  EXPECT_EQ(reply.experience->paths[1].source, Digest());
}

TEST(WithheldSources, QueriesThatOthersRecordedLoseTheirReport) {
  FetchReply reply = reply_of_three();
  reply.recall.emplace().queries.resize(2);
  for (RecallQuery& query : reply.recall->queries)
    query.report = Uuid::random();
  reply.recall->queries[1].is_synthetic = true;
  const RecallLibrary whole = *reply.recall;
  withhold_sources(for_robots({}), digest_of(1), reply);
  EXPECT_EQ(reply.recall->queries[1].report, whole.queries[1].report);
  withhold_sources(for_robots({"pupil"}), digest_of(1), reply);
  EXPECT_EQ(reply.recall->queries[0].report, whole.queries[0].report);
  EXPECT_EQ(reply.recall->queries[1].report, Uuid());
}

TEST(WithheldSources, OnlyCertificatesForSomeRobotsHaveLess) {
  EXPECT_TRUE(withholds_sources(for_robots({"pupil"})));
  EXPECT_FALSE(withholds_sources(for_robots({})));
  FetchReply reply = reply_of_three();
  withhold_sources(for_robots({}), Digest(), reply);
  EXPECT_EQ(reply.distribution->sources[1].label, "teacher");
}

}  // namespace
}  // namespace kinship::access::withheld_sources_test
