// Decoding what was encoded gives the same value; decoding anything else gives an error or a value
// that keeps the rules, never a crash.

#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec {
namespace {

constexpr std::uint64_t kSeed = 31;
constexpr int kCases = 200;
constexpr double kPoseTolerance = 1e-12;
const Head kHead{Uuid{}, 7};

/// Poses pass as quaternions and come back within rounding; after this check they are made equal,
/// so that the rest can be compared exactly, as JSON.
void expect_same_pose(const std::optional<Eigen::Isometry3d>& written,
                      std::optional<Eigen::Isometry3d>& read) {
  ASSERT_EQ(read.has_value(), written.has_value());
  if (!written)
    return;
  EXPECT_TRUE(read->isApprox(*written, kPoseTolerance));
  read = written;
}

TEST(CodecRoundTrip, BatchOfAttemptsComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    ReportRequest written;
    for (int n = values.below(10); n > 0; --n)
      written.attempts.push_back(values.attempt());
    const auto message = encode(kHead, written);
    ASSERT_TRUE(message) << message.error().message;
    EXPECT_EQ(head_of(message->wire), kHead);
    auto read = decode(message->wire).value_or_throw();
    ASSERT_EQ(read.attempts.size(), written.attempts.size());
    EXPECT_TRUE(read.refused.empty());
    for (std::size_t n = 0; n < written.attempts.size(); ++n) {
      expect_same_pose(written.attempts[n].T_task_base, read.attempts[n].T_task_base);
      EXPECT_EQ(json::to_json(read.attempts[n]), json::to_json(written.attempts[n]));
    }
  }
}

TEST(CodecRoundTrip, RobotDescriptionComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    const RobotDescription written = values.robot_description();
    auto read = decode(encode(kHead, written).value_or_throw().wire).value_or_throw();
    EXPECT_TRUE(read.T_tip_transfer.isApprox(written.T_tip_transfer, kPoseTolerance));
    read.T_tip_transfer = written.T_tip_transfer;
    EXPECT_EQ(json::to_json(read), json::to_json(written));
  }
}

TEST(CodecRoundTrip, DistributionComesBack) {
  test::RandomValues values(kSeed);
  for (int i = 0; i < kCases; ++i) {
    FetchReply written;
    written.distribution = values.distribution();
    written.status = written.distribution->state == DistributionState::Ready ? FetchStatus::Ready
                                                                             : FetchStatus::Failed;
    const auto message = encode(kHead, written);
    ASSERT_TRUE(message) << message.error().message;
    auto read = decode(message->wire).value_or_throw();
    EXPECT_EQ(read.status, written.status);
    expect_same_pose(written.distribution->T_task_base, read.distribution->T_task_base);
    EXPECT_EQ(json::to_json(*read.distribution), json::to_json(*written.distribution));
  }
}

/// Changes one member of a message that decoding reads, within the memory that it has.
class Vandal {
 public:
  explicit Vandal(test::RandomValues& values) : values_(values) {}

  void spoil(kinship_wire_Attempt& wire) {
    switch (values_.below(12)) {
      case 0:
        return spoil(wire.machine);
      case 1:
        return spoil(wire.task);
      case 2:
        return spoil(wire.T_task_base);
      case 3:
        return spoil(wire.record.outcome);
      case 4:
        return spoil(wire.record.planner);
      case 5:
        return spoil(wire.record.planner_options);
      case 6:
        return spoil(wire.record.planning_time_s);
      case 7:
        return spoil(wire.record.arm);
      case 8:
        return spoil(wire.record.share);
      case 9:
        return spoil(wire.record.distribution_id);
      case 10:
        return spoil(wire.dof);
      default:
        return spoil(wire.waypoints);
    }
  }

  void spoil(kinship_wire_Distribution& wire) {
    switch (values_.below(11)) {
      case 0:
        return spoil(wire.task);
      case 1:
        return spoil(wire.T_task_base);
      case 2:
        return spoil(wire.state);
      case 3:
        return spoil(wire.limits);
      case 4:
        return spoil(wire.held_out_score);
      case 5:
        return spoil(wire.recommended_share);
      case 6:
        return spoil(wire.evidence);
      case 7:
        wire.mixture._length = 0;
        return;
      default:
        break;
    }
    if (wire.mixture._length == 0)
      return;
    kinship_wire_Mixture& mixture = wire.mixture._buffer[0];
    spoil(values_.coin() ? mixture.weights : values_.coin() ? mixture.means : mixture.covariances);
  }

 private:
  void spoil(char*& text) {
    if (values_.coin()) {
      text = nullptr;
      return;
    }
    for (char* c = text; c && *c != '\0'; ++c)
      if (values_.below(4) == 0)
        *c = static_cast<char>(values_.below(256));
  }
  void spoil(double& number) {
    constexpr double kBad[] = {std::numeric_limits<double>::quiet_NaN(), -1, 1e300,
                               -std::numeric_limits<double>::infinity(), 2};
    number = kBad[values_.below(5)];
  }
  void spoil(std::uint32_t& number) {
    number = static_cast<std::uint32_t>(values_.generator()()) >>
             static_cast<unsigned>(values_.below(32));
  }
  void spoil(dds_sequence_octet& sequence) { shorten(sequence); }
  void spoil(dds_sequence_double& sequence) {
    if (values_.coin() && sequence._length > 0)
      spoil(sequence._buffer[values_.below(static_cast<int>(sequence._length))]);
    else
      shorten(sequence);
  }
  template <typename Sequence>
  void shorten(Sequence& sequence) {
    sequence._length =
        static_cast<std::uint32_t>(values_.below(static_cast<int>(sequence._length) + 1));
    if (values_.below(4) == 0)
      sequence._buffer = nullptr;  // what a shorter message leaves
  }

  test::RandomValues& values_;
};

TEST(CodecGarbage, SpoiledAttemptIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  std::size_t refused = 0;
  for (int i = 0; i < 20 * kCases; ++i) {
    ReportRequest written;
    written.attempts = {values.attempt(5), values.attempt(5)};
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.attempts._buffer[0]);
    const auto read = decode(message.wire).value_or_throw();
    EXPECT_EQ(read.attempts.size() + read.refused.size(), 2U);
    for (const Attempt& attempt : read.attempts)
      EXPECT_FALSE(check(attempt));
    refused += read.refused.size();
  }
  EXPECT_GT(refused, static_cast<std::size_t>(5 * kCases));
}

TEST(CodecGarbage, SpoiledDistributionIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  int refused = 0;
  for (int i = 0; i < 10 * kCases; ++i) {
    FetchReply written;
    written.distribution = values.distribution();
    written.status = written.distribution->state == DistributionState::Ready ? FetchStatus::Ready
                                                                             : FetchStatus::Failed;
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.distribution._buffer[0]);
    const auto read = decode(message.wire);
    if (read)
      EXPECT_FALSE(check(*read->distribution));
    else
      ++refused;
  }
  EXPECT_GT(refused, 3 * kCases);
}

}  // namespace
}  // namespace kinship::codec
