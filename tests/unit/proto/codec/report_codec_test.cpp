#include "proto/codec/report_codec.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/random_values.hpp"

namespace kinship::codec::report_codec_test {
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

/// What an attempt breaks; as a message it is then refused, too.
std::string complaint(const Attempt& attempt) {
  const auto error = validate(attempt);
  // What is too large for a message cannot be encoded.
  if (const auto message = encode({}, ReportRequest{{attempt}, {}})) {
    EXPECT_EQ(decode(message->wire)->refused.size(), error ? 1U : 0U);
  } else {
    EXPECT_TRUE(error);
  }
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

RecordedScene cups_on_a_table(int cups) {
  RecordedScene scene;
  scene.objects.push_back({"table", BoxShape{{1, 2, 0.1}}});
  for (int i = 0; i < cups; ++i)
    scene.objects.push_back({"cup", CylinderShape{0.04, 0.1}});
  scene.held.push_back({"can", SphereShape{0.05}});
  scene.allowed_collisions.emplace_back("can", "table");
  return scene;
}

TEST(ReportCodec, NamesTheRuleThatASceneBreaks) {
  Attempt good = solved_attempt(7, 3);
  good.scene = cups_on_a_table(3);
  EXPECT_EQ(complaint(good), "");
  Attempt bad = good;
  bad.scene->objects[0].shape = BoxShape{{1, 0, 1}};
  EXPECT_EQ(complaint(bad), "scene: 'table': size 0 m is not above 0 and at most 1000 m");
  bad.scene->objects[0].shape = BoxShape{{1, 1, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_EQ(complaint(bad), "scene: 'table': size nan m is not above 0 and at most 1000 m");
  bad = good;
  bad.scene->held[0].T_transfer_object.translation().x() = 2000;
  EXPECT_EQ(complaint(bad),
            "scene: 'can': pose: coordinate 2000 m exceeds 1000 m; these are probably millimetres");
  bad = good;
  bad.scene->held[0].name = "";
  EXPECT_EQ(complaint(bad), "scene: a name is empty");
  bad = good;
  bad.scene->allowed_collisions.emplace_back("can", "panda_hand");
  EXPECT_EQ(complaint(bad),
            "scene: allowed_collisions names 'panda_hand', which is neither an object nor held");
  bad = good;
  bad.scene = cups_on_a_table(2048);
  EXPECT_EQ(complaint(bad), "scene: 2049 objects exceed 2048");
  bad.scene = cups_on_a_table(2000);
  for (SceneObject& object : bad.scene->objects)
    object.name += std::string(40, '_');
  bad.scene->allowed_collisions.clear();
  EXPECT_EQ(complaint(bad), "scene: 278240 bytes exceed 262144");
}

TEST(ReportCodec, BadSceneOnTheWireIsRefusedAlone) {
  ReportRequest request;
  request.attempts = {solved_attempt(7, 3), solved_attempt(7, 3), solved_attempt(7, 3)};
  request.attempts[0].scene = request.attempts[1].scene = cups_on_a_table(1);
  auto message = encode({}, request).value_or_throw();
  kinship_wire_RecordedScene& scene = message.wire.attempts._buffer[1].scene._buffer[0];
  EXPECT_EQ(decode(message.wire)->attempts.size(), 3U);
  scene.objects._buffer[1].shape = 4;
  EXPECT_EQ(decode(message.wire)->refused.at(0).message, "scene: shape: 4 is not between 0 and 3");
  scene.objects._buffer[1].shape = 3;
  scene.objects._buffer[1].size[1] = -1;
  EXPECT_EQ(decode(message.wire)->refused.at(0).message,
            "scene: 'cup': size -1 m is not above 0 and at most 1000 m");
  scene.objects._buffer[1].size[1] = 1;
  scene.objects._buffer[1].pose[6] = 3;
  EXPECT_EQ(decode(message.wire)->refused.at(0).message.find("scene: 'cup': pose: "), 0U);
  scene.objects._buffer = nullptr;  // what a shorter message leaves
  EXPECT_EQ(decode(message.wire)->refused.at(0).message,
            "scene: allowed_collisions names 'table', which is neither an object nor held");
}

/// Everything may be anywhere, but not tilted.
TaskSpaceRegion level() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  TaskSpaceRegion region = {};
  region.T_region_end.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  region.bounds << -kInfinity, -kInfinity, 0, -0.1, -0.2, -kInfinity,  //
      kInfinity, kInfinity, kInfinity, 0.1, 0.2, kInfinity;
  return region;
}

TEST(ReportCodec, ABadConstraintIsRefusedByName) {
  ReportRequest request;
  request.attempts = {solved_attempt(7, 3)};
  request.attempts[0].scene = cups_on_a_table(1);
  request.attempts[0].scene->constraint = level();
  auto message = encode({}, request).value_or_throw();
  kinship_wire_TaskSpaceRegion& wire =
      message.wire.attempts._buffer[0].scene._buffer[0].constraint._buffer[0];
  const auto complaint = [&message] { return decode(message.wire)->refused.at(0).message; };
  wire.bounds[6] = 0.3;
  EXPECT_EQ(complaint(), "scene: constraint: Bw of roll: lower 0.3 exceeds upper 0.1");
  wire.bounds[6] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(complaint(), "scene: constraint: Bw of roll: is not a number");
  wire.bounds[6] = -0.1;
  wire.T_task_region[0] = -1001;
  EXPECT_EQ(complaint(),
            "scene: constraint: T0_w: pose: coordinate -1001 m exceeds 1000 m; these are probably "
            "millimetres");
  wire.T_task_region[0] = 0;
  wire.T_region_end[6] = 3;
  EXPECT_EQ(complaint().find("scene: constraint: Tw_e: pose: "), 0U);
  wire.T_region_end[6] = 0;
  EXPECT_EQ(decode(message.wire)->attempts.size(), 1U);
  request.attempts[0].scene->constraint->bounds(0, 3) = 0.3;
  EXPECT_EQ(validate(request.attempts[0])->message,
            "scene: constraint: Bw of roll: lower 0.3 exceeds upper 0.1");
  message.wire.attempts._buffer[0].scene._buffer[0].constraint._buffer = nullptr;
  EXPECT_FALSE(decode(message.wire)->attempts.at(0).scene->constraint) << "of an older client";
}

TEST(ReportCodec, ScenesOfABatchAreLimitedTogether) {
  ReportRequest request;
  request.attempts.assign(2, solved_attempt(1, 2));
  for (Attempt& attempt : request.attempts)
    attempt.scene = cups_on_a_table(1500);
  EXPECT_EQ(encode({}, request).error().message,
            "scenes of a batch (bytes): 297448 exceeds 262144");
  request.attempts[0].scene->constraint = level();
  EXPECT_EQ(encode({}, request).error().message,
            "scenes of a batch (bytes): 297664 exceeds 262144");
  request.attempts.resize(1);
  request.attempts[0].path = Path(Eigen::MatrixXd::Zero(4, 16384));
  EXPECT_TRUE(encode({}, request));  // the largest path with a large scene is one sample
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

TEST(ReportCodec, MarksComeBackAndHaveALimit) {
  const ConsistencyToken token(kMaxConsistencyTokenBytes, 0xa5);
  const ConsistencyToken too_long(kMaxConsistencyTokenBytes + 1, 0xa5);
  auto request = encode({}, ReportRequest{{}, {}, token}).value_or_throw();
  EXPECT_EQ(decode(request.wire)->known_token, token);
  EXPECT_EQ(encode({}, ReportRequest{{}, {}, too_long}).error().code, ErrorCode::TooLarge);
  request.arena->resize(request.wire.known_token, too_long.size());
  EXPECT_EQ(decode(request.wire).error().message, "known_token: 65 exceeds 64");
  request.wire.known_token._buffer = nullptr;  // what a shorter message leaves
  EXPECT_TRUE(decode(request.wire)->known_token.empty());

  auto reply = encode({}, ReportReply{{}, {}, token}).value_or_throw();
  EXPECT_EQ(decode(reply.wire)->consistency_token, token);
  EXPECT_EQ(encode({}, ReportReply{{}, {}, too_long}).error().code, ErrorCode::TooLarge);
  reply.arena->resize(reply.wire.consistency_token, too_long.size());
  EXPECT_EQ(decode(reply.wire).error().message, "consistency_token: 65 exceeds 64");
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
}  // namespace kinship::codec::report_codec_test
