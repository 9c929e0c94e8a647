// A library of paths to recall, in a fetch.

#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/fetch_codec.hpp"
#include "proto/types/limits.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::recall_codec_test {
namespace {

constexpr std::uint64_t kSeed = 32;

/// One query, one path and one mode at least, two anchors, of three joints.
RecallLibrary library() {
  test::RandomValues values(kSeed);
  RecallLibrary library = values.recall_library(3);
  library.anchors = {"shelf", "table"};
  for (RecallQuery& query : library.queries)
    query.T_task_anchors = {values.pose(), values.pose()};
  return library;
}

FetchReply reply_with(RecallLibrary library) {
  FetchReply reply;
  reply.status = FetchStatus::Pending;
  reply.recall = std::move(library);
  return reply;
}

/// What decoding says of a message that was changed on its way.
template <typename Change>
std::string fault_after(Change change) {
  auto message = encode({}, reply_with(library())).value_or_throw();
  change(message.wire.recall._buffer[0]);
  const auto read = decode(message.wire);
  return read ? "" : read.error().message;
}

void expect_same(const RecallLibrary& read, const RecallLibrary& written) {
  constexpr double kPoseTolerance = 1e-12;
  EXPECT_EQ(read.revision, written.revision);
  EXPECT_EQ(read.search_checks, written.search_checks);
  EXPECT_EQ(read.try_checks, written.try_checks);
  EXPECT_EQ(read.anchors, written.anchors);
  EXPECT_EQ(read.modes, written.modes);
  EXPECT_EQ(read.solves, written.solves);
  EXPECT_EQ(read.reaches, written.reaches);
  ASSERT_EQ(read.queries.size(), written.queries.size());
  for (std::size_t i = 0; i < read.queries.size(); ++i) {
    const RecallQuery &one = read.queries[i], &other = written.queries[i];
    EXPECT_EQ(one.report, other.report);
    EXPECT_EQ(one.is_synthetic, other.is_synthetic);
    EXPECT_TRUE(one.T_task_base.isApprox(other.T_task_base, kPoseTolerance));
    EXPECT_EQ(one.start, other.start);
    EXPECT_EQ(one.goal, other.goal);
    ASSERT_EQ(one.T_task_anchors.size(), other.T_task_anchors.size());
    for (std::size_t j = 0; j < one.T_task_anchors.size(); ++j)
      EXPECT_TRUE(one.T_task_anchors[j].isApprox(other.T_task_anchors[j], kPoseTolerance));
  }
  ASSERT_EQ(read.paths.size(), written.paths.size());
  for (std::size_t i = 0; i < read.paths.size(); ++i) {
    EXPECT_EQ(read.paths[i].query, written.paths[i].query);
    EXPECT_EQ(read.paths[i].waypoints, written.paths[i].waypoints);
  }
}

TEST(RecallCodec, ALibraryComesBackWithAnyNumberOfJoints) {
  test::RandomValues values(kSeed);
  for (const Eigen::Index dof : {1, 7, static_cast<int>(kMaxDof)}) {
    const RecallLibrary written = values.recall_library(dof);
    const auto message = encode({}, reply_with(written)).value_or_throw();
    expect_same(decode(message.wire).value_or_throw().recall.value(), written);
  }
}

TEST(RecallCodec, NoneIsNotAnEmptyOne) {
  RecallLibrary none;
  none.revision = 9;
  auto message = encode({}, reply_with(none)).value_or_throw();
  const auto read = decode(message.wire).value_or_throw();
  ASSERT_TRUE(read.recall);
  EXPECT_EQ(read.recall->revision, 9U);
  message.wire.recall._buffer = nullptr;  // of an older server
  EXPECT_FALSE(decode(message.wire).value_or_throw().recall);
}

TEST(RecallCodec, TheRevisionThatIsKnownComesBack) {
  FetchRequest written;
  written.task = "shelf_pick";
  written.known_recall = std::numeric_limits<std::uint64_t>::max();
  EXPECT_EQ(decode(encode({}, written)->wire)->known_recall, written.known_recall);
  written.start = {0.5, -1.25};
  EXPECT_EQ(decode(encode({}, written)->wire)->start, written.start);
  written.start.resize(kMaxDof + 1);
  EXPECT_EQ(encode({}, written).error().message, "start: 33 exceeds 32");
}

TEST(RecallCodec, ALibraryThatBreaksARuleIsNeitherSentNorRead) {
  RecallLibrary bad = library();
  bad.revision = 0;
  EXPECT_EQ(encode({}, reply_with(bad)).error().message, "recall: revision 0");
  EXPECT_EQ(fault_after([](auto& wire) { wire.revision = 0; }), "recall: revision 0");
  EXPECT_EQ(fault_after([](auto& wire) { wire.modes._buffer[0].blend = 3; }),
            "recall: mode 0: blend: 3 is not between 0 and 2");
  EXPECT_EQ(fault_after([](auto& wire) { wire.try_checks = -1; }),
            "recall: try_checks: -1 is negative");
  EXPECT_EQ(fault_after([](auto& wire) { wire.reaches._length = 0; }).find("recall: reaches: 0"),
            0U);
  EXPECT_EQ(fault_after([](auto& wire) {
              wire.queries._buffer[0].T_task_base[6] = 3;
            }).find("recall: T_task_base: "),
            0U);
  EXPECT_EQ(fault_after([](auto& wire) {
              wire.paths._buffer[0].waypoints._buffer[5] = std::numeric_limits<float>::infinity();
            }),
            "recall: path 0: not finite as float");
}

TEST(RecallCodec, CountsAreLookedAtBeforeAnythingIsRead) {
  EXPECT_EQ(fault_after([](auto& wire) { wire.anchors._length = 3; }),
            "recall: anchors: 3 exceeds 2");
  EXPECT_EQ(fault_after([](auto& wire) { wire.queries._length = 257; }),
            "recall: queries: 257 exceeds 256");
  EXPECT_EQ(fault_after([](auto& wire) { wire.paths._length = 513; }),
            "recall: paths: 513 exceeds 512");
  EXPECT_EQ(fault_after([](auto& wire) { wire.modes._length = 17; }),
            "recall: modes: 17 exceeds 16");
  EXPECT_EQ(fault_after([](auto& wire) { wire.solves._length = 262'145; }),
            "recall: solves: 262145 exceeds 262144");
  EXPECT_EQ(fault_after([](auto& wire) { wire.reaches._length = 262'145; }),
            "recall: reaches: 262145 exceeds 262144");
  EXPECT_EQ(fault_after([](auto& wire) { wire.queries._buffer[0].start._length = 33; }),
            "recall: start: 33 exceeds 32");
  EXPECT_EQ(fault_after([](auto& wire) { wire.queries._buffer[0].T_task_anchors._length = 13; }),
            "recall: T_task_anchors: 13 numbers are not a multiple of 7");
  EXPECT_EQ(fault_after([](auto& wire) { wire.queries._buffer[0].T_task_anchors._length = 21; }),
            "recall: T_task_anchors: 3 exceeds 2");
  EXPECT_EQ(fault_after([](auto& wire) { wire.paths._buffer[0].waypoints._length = 95; }),
            "recall: waypoints: 95 numbers are not a multiple of 32");
  EXPECT_EQ(fault_after([](auto& wire) { wire.paths._buffer[0].waypoints._length = 33 * 32; }),
            "recall: joints of waypoints: 33 exceeds 32");
}

TEST(RecallCodec, BytesThatItCountsAreThoseOfAMessage) {
  test::RandomValues values(kSeed);
  FetchReply without;
  without.status = FetchStatus::Pending;
  const std::size_t rest = encode({}, without)->arena->bytes();
  for (int i = 0; i < 100; ++i) {
    const RecallLibrary written = values.recall_library(1 + values.below(32), 100);
    const std::size_t bytes = encode({}, reply_with(written))->arena->bytes() - rest;
    EXPECT_GE(recall_bytes(written), bytes);
    EXPECT_LE(static_cast<double>(recall_bytes(written)), 1.1 * static_cast<double>(bytes) + 100);
  }
}

TEST(RecallCodec, ALibraryThatFillsASampleIsRefused) {
  RecallLibrary largest = library();
  const RecallPath path{0, Eigen::MatrixXd::Zero(32, kRecallWaypoints)};
  for (RecallQuery& query : largest.queries)
    query.start = query.goal = Eigen::VectorXd::Zero(32);
  largest.paths.assign(kMaxRecallPaths, path);
  largest.solves.resize((largest.queries.size() * largest.paths.size() * largest.modes.size() + 7) /
                        8);
  largest.reaches = largest.solves;
  EXPECT_FALSE(validate(largest));
  EXPECT_EQ(encode({}, reply_with(largest)).error().code, ErrorCode::TooLarge);
}

}  // namespace
}  // namespace kinship::codec::recall_codec_test
