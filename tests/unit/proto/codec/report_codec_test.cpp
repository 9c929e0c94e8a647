#include "proto/codec/report_codec.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_values.hpp"

namespace kinship::codec {
namespace {

constexpr std::uint64_t kSeed = 32;

Attempt solved_attempt(Eigen::Index dof, Eigen::Index waypoints) {
  test::RandomValues values(kSeed);
  Attempt attempt = values.attempt();
  attempt.report_uuid = Uuid::random();
  attempt.record.outcome = Outcome::Solved;
  attempt.path = Path(Eigen::MatrixXd::Zero(dof, waypoints));
  return attempt;
}

std::string complaint(const Attempt& attempt) {
  const auto error = check(attempt);
  return error ? error->message : "";
}

TEST(ReportCodec, NamesTheRuleThatAnAttemptBreaks) {
  const Attempt good = solved_attempt(7, 3);
  EXPECT_EQ(complaint(good), "");
  Attempt bad = good;
  bad.task = "bin to shelf";
  EXPECT_EQ(complaint(bad), "task: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  bad = good;
  bad.record.share = 1.5;
  EXPECT_EQ(complaint(bad), "share: 1.5 is not between 0 and 1");
  bad = good;
  bad.record.planning_time_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(bad), "planning_time_s: nan is not finite");
  bad = good;
  bad.path.reset();
  EXPECT_EQ(complaint(bad), "waypoints: missing although solved");
  bad = good;
  bad.record.outcome = Outcome::Timeout;
  EXPECT_EQ(complaint(bad), "waypoints: given although not solved");
  bad = good;
  bad.report_uuid = {};
  EXPECT_EQ(complaint(bad), "report_uuid: is zero");
}

TEST(ReportCodec, SizesAreLimited) {
  EXPECT_EQ(complaint(solved_attempt(4, 16384)), "");
  EXPECT_EQ(complaint(solved_attempt(4, 16385)), "waypoints: 16385 exceeds 16384");
  EXPECT_EQ(complaint(solved_attempt(33, 2)), "dof: 33 exceeds 32");
  EXPECT_EQ(complaint(solved_attempt(32, 16384)), "waypoints (bytes): 4194304 exceeds 524288");
}

TEST(ReportCodec, BatchIsLimitedWhenItIsEncoded) {
  ReportRequest request;
  request.attempts.assign(257, solved_attempt(1, 2));
  EXPECT_EQ(encode({}, request).error().code, ErrorCode::TooLarge);
  request.attempts.assign(2, solved_attempt(3, 16384));
  EXPECT_EQ(encode({}, request).error().message,
            "waypoints of a batch (bytes): 786432 exceeds 524288");
}

TEST(ReportCodec, FullBatchFitsIntoASample) {
  ReportRequest request;
  Attempt attempt = solved_attempt(8, 32);
  attempt.task = std::string(128, 't');
  attempt.machine = attempt.record.planner = std::string(128, 'p');
  attempt.record.planner_options = std::string(1024, 'o');
  request.attempts.assign(256, attempt);
  EXPECT_TRUE(encode({}, request));
}

TEST(ReportCodec, BadAttemptOfABatchIsRefusedAloneByUuid) {
  ReportRequest request;
  request.attempts = {solved_attempt(7, 3), solved_attempt(7, 3), solved_attempt(7, 3)};
  auto message = encode({}, request).value_or_throw();
  message.wire.attempts._buffer[1].waypoints._buffer[9] = std::numeric_limits<double>::infinity();
  const auto read = decode(message.wire).value_or_throw();
  ASSERT_EQ(read.attempts.size(), 2U);
  EXPECT_EQ(read.attempts[1].report_uuid, request.attempts[2].report_uuid);
  ASSERT_EQ(read.refused.size(), 1U);
  EXPECT_EQ(read.refused[0].report_uuid, request.attempts[1].report_uuid);
  EXPECT_EQ(read.refused[0].status, ReceiptStatus::Refused);
  EXPECT_EQ(read.refused[0].message, "waypoint 2, joint 3: inf is not finite");
}

TEST(ReportCodec, WaypointsMustFitTheDof) {
  ReportRequest request;
  request.attempts = {solved_attempt(7, 3)};
  auto message = encode({}, request).value_or_throw();
  kinship_wire_Attempt& wire = message.wire.attempts._buffer[0];
  for (const std::uint32_t dof : {0U, 4U, 21U, 33U, 4'000'000'000U}) {
    wire.dof = dof;
    EXPECT_EQ(decode(message.wire)->refused.size(), 1U) << dof;
  }
  wire.dof = 7;
  wire.waypoints._length = 7;  // one waypoint
  EXPECT_EQ(decode(message.wire)->refused[0].message, "waypoints: 1, must be at least 2");
}

TEST(ReportCodec, AttemptWithoutARecordIsRefused) {
  ReportRequest request;
  request.attempts = {solved_attempt(7, 3), solved_attempt(7, 3)};
  auto message = encode({}, request).value_or_throw();
  message.wire.attempts._buffer[0].record._length = 0;
  message.wire.attempts._buffer[1].record._buffer = nullptr;  // what a shorter message leaves
  const auto read = decode(message.wire).value_or_throw();
  ASSERT_EQ(read.refused.size(), 2U);
  EXPECT_EQ(read.refused[0].message, "record: is missing");
  EXPECT_EQ(read.refused[1].message, "record: is missing");
}

TEST(ReportCodec, ReceiptsComeBack) {
  ReportReply written{Uuid::random(),
                      {{Uuid::random(), ReceiptStatus::Stored, ""},
                       {Uuid::random(), ReceiptStatus::Refused, "share: 2"},
                       {Uuid::random(), ReceiptStatus::UnknownRobot, "robot 'x': unknown"}}};
  const auto read = decode(encode({}, written)->wire).value_or_throw();
  EXPECT_EQ(read.store_epoch, written.store_epoch);
  ASSERT_EQ(read.receipts.size(), 3U);
  EXPECT_EQ(read.receipts[1].report_uuid, written.receipts[1].report_uuid);
  EXPECT_EQ(read.receipts[1].status, ReceiptStatus::Refused);
  EXPECT_EQ(read.receipts[1].message, "share: 2");
  EXPECT_EQ(read.receipts[2].status, ReceiptStatus::UnknownRobot);
  EXPECT_EQ(read.receipts[2].message, "robot 'x': unknown");
}

TEST(ReportCodec, AnOddMessageHoldsNoReceiptBack) {
  const ReportReply written{Uuid::random(),
                            {{Uuid::random(), ReceiptStatus::Refused, "joint 'j\x01'"},
                             {Uuid::random(), ReceiptStatus::Refused, std::string(5000, 'x')},
                             {Uuid::random(), ReceiptStatus::Stored, ""}}};
  const auto read = decode(encode({}, written)->wire).value_or_throw();
  ASSERT_EQ(read.receipts.size(), 3U);
  EXPECT_EQ(read.receipts[0].message, "joint 'j?'");
  EXPECT_EQ(read.receipts[1].message.size(), kMaxMessageBytes);
}

}  // namespace
}  // namespace kinship::codec
