// Decoding what was spoiled gives an error or a value that keeps the rules, never a crash.

#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/publication_codec.hpp"
#include "proto/codec/report_codec.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::codec_garbage_test {
namespace {

constexpr std::uint64_t kSeed = 31;
constexpr int kCases = 200;
const Head kHead{Uuid{}, 7};

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
        return shorten(wire.record);
      case 4:
        return spoil(wire.dof);
      case 5:
        return spoil(wire.waypoints);
      case 6:
      case 7:
      case 8:
        return wire.scene._length > 0 ? spoil(wire.scene._buffer[0]) : shorten(wire.scene);
      default:
        return spoil(wire.record._buffer[0]);
    }
  }

  void spoil(kinship_wire_RecordedScene& wire) {
    const bool one_is_held = wire.held._length > 0 && values_.coin();
    auto* const solid = one_is_held                ? &wire.held._buffer[0]
                        : wire.objects._length > 0 ? &wire.objects._buffer[0]
                                                   : nullptr;
    if (wire.constraint._length > 0 && values_.below(3) == 0)
      return spoil(wire.constraint._buffer[0]);
    switch (solid == nullptr ? values_.below(3) : values_.below(7)) {
      case 0:
        return shorten(wire.objects);
      case 1:
        return shorten(wire.held);
      case 2:
        return shorten(wire.allowed_collisions);
      case 3:
        return spoil(solid->name);
      case 4:
        return spoil(solid->shape);
      case 5:
        return spoil(solid->size[values_.below(3)]);
      default:
        return spoil(solid->pose[values_.below(7)]);
    }
  }

  void spoil(kinship_wire_TaskSpaceRegion& wire) {
    switch (values_.below(3)) {
      case 0:
        return spoil(wire.T_task_region[values_.below(7)]);
      case 1:
        return spoil(wire.T_region_end[values_.below(7)]);
      default:
        return spoil(wire.bounds[values_.below(12)]);
    }
  }

  void spoil(kinship_wire_Rehearsal& wire) {
    kinship_wire_GuideCost* const cost = wire.costs._length > 0 ? &wire.costs._buffer[0] : nullptr;
    switch (cost == nullptr ? values_.below(4) : values_.below(8)) {
      case 0:
        return spoil(wire.guide);
      case 1:
        return spoil(wire.processor_time_s);
      case 2:
        return shorten(wire.costs);
      case 3:
        return spoil(wire.message);
      case 4:
        return spoil(cost->guide);
      case 5:
        cost->solved = cost->plans + 1;
        return;
      case 6:
        return spoil(cost->mean_checks);
      default:
        return spoil(cost->median_checks);
    }
  }

  void spoil(kinship_wire_PlanningRecord& wire) {
    switch (values_.below(7)) {
      case 0:
        return spoil(wire.outcome);
      case 1:
        return spoil(wire.planner);
      case 2:
        return spoil(wire.planner_options);
      case 3:
        return spoil(wire.planning_time_s);
      case 4:
        return spoil(wire.sampling_mode);
      case 5:
        return spoil(wire.share);
      default:
        return spoil(wire.distribution_id);
    }
  }

  void spoil(kinship_wire_Selection& wire) {
    switch (values_.below(4)) {
      case 0:
        return shorten(wire.sources);
      case 1:  // no longer ascending
        for (std::uint32_t i = 0; i < wire.sources._length; ++i)
          wire.sources._buffer[i] = static_cast<std::uint8_t>(values_.below(256));
        return;
      case 2:
        return spoil(wire.weighting);
      default:
        wire.since_ms = -1;
        return;
    }
  }

  void spoil(kinship_wire_ArmEvidence& wire) {
    if (values_.coin())
      wire.solved = wire.attempts + 1;
    else
      spoil(wire.checks_per_solution);
  }

  void spoil(kinship_wire_JudgedAttempt& wire) {
    if (values_.coin())
      spoil(wire.sampling_mode);
    else
      wire.age = static_cast<std::uint32_t>(values_.below(10));  // no longer oldest first
  }

  void spoil(kinship_wire_Source& wire) {
    switch (values_.below(3)) {
      case 0:
        return spoil(wire.label);
      case 1:
        return spoil(wire.relation);
      default:
        return spoil(wire.mass);
    }
  }

  void spoil(kinship_wire_Event& wire) {
    switch (values_.below(4)) {
      case 0:
        return spoil(wire.kind);
      case 1:
        return spoil(wire.task);
      case 2:
        return spoil(wire.robot);
      default:
        return spoil(wire.text);
    }
  }

  void spoil(kinship_wire_Announcement& wire) { spoil(wire.task); }

  void spoil(kinship_wire_Distribution& wire) {
    switch (values_.below(20)) {
      case 19:
        return wire.fit._length > 0 ? spoil(wire.fit._buffer[0].reason) : void();
      case 0:
        return spoil(wire.task);
      case 1:
        return spoil(wire.T_task_base);
      case 2:
        return spoil(wire.state);
      case 8:
        return wire.selection._length > 0 ? spoil(wire.selection._buffer[0]) : void();
      case 9:
        return wire.guided._length > 0 ? spoil(wire.guided._buffer[0]) : void();
      case 10:
        return wire.sources._length > 0 ? spoil(wire.sources._buffer[0]) : void();
      case 11:
        return wire.recent._length > 0 ? spoil(wire.recent._buffer[0]) : void();
      case 12:
        return spoil(wire.guided_share);
      case 13:
        return wire.component_scores._length > 0 ? spoil(wire.component_scores._buffer[0].score)
                                                 : void();
      case 14:
        return wire.cuts._length > 0 ? spoil(wire.cuts._buffer[0].joint) : void();
      case 3:
        return spoil(wire.limits);
      case 4:
        return spoil(wire.held_out_score);
      case 5:
        return spoil(wire.recommended_share);
      case 6:
        return spoil(wire.evidence);
      case 7:
        wire.mixture._length = wire.kernels._length = 0;
        return;
      default:
        break;
    }
    if (wire.kernels._length != 0) {
      kinship_wire_Kernels& kernels = wire.kernels._buffer[0];
      spoil(values_.coin() ? kernels.weights : kernels.covariance);
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
    written.attempts[0].scene = values.recorded_scene();
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.attempts._buffer[0]);
    const auto read = decode(message.wire).value_or_throw();
    EXPECT_EQ(read.attempts.size() + read.refused.size(), 2U);
    for (const Attempt& attempt : read.attempts)
      EXPECT_FALSE(validate(attempt));
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
    written.status =
        has_mixture(written.distribution->state) ? FetchStatus::Ready : FetchStatus::Failed;
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.distribution._buffer[0]);
    const auto read = decode(message.wire);
    if (read)
      EXPECT_FALSE(validate(*read->distribution));
    else
      ++refused;
  }
  EXPECT_GT(refused, 3 * kCases);
}

TEST(CodecGarbage, SpoiledSelectionIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  int refused = 0;
  for (int i = 0; i < 20 * kCases; ++i) {
    FetchRequest written;
    written.task = "t";
    written.selection = values.selection();
    written.selection.since_ms = 1;  // so that there is one
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.selection._buffer[0]);
    const auto read = decode(message.wire);
    if (read)
      EXPECT_FALSE(validate(*read));
    else
      ++refused;
  }
  EXPECT_GT(refused, 5 * kCases);
}

TEST(CodecGarbage, SpoiledRehearsalIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  int refused = 0;
  for (int i = 0; i < 10 * kCases; ++i) {
    FetchReply written;
    written.status = FetchStatus::Pending;
    written.rehearsal = values.rehearsal();
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.rehearsal._buffer[0]);
    const auto read = decode(message.wire);
    if (read)
      EXPECT_FALSE(validate(*read->rehearsal));
    else
      ++refused;
  }
  EXPECT_GT(refused, 3 * kCases);
}

TEST(CodecGarbage, SpoiledPublicationIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  int refused = 0;
  for (int i = 0; i < 10 * kCases; ++i) {
    auto event = encode(values.event()).value_or_throw();
    vandal.spoil(event.wire);
    auto announcement = encode(values.announcement()).value_or_throw();
    vandal.spoil(announcement.wire);
    const auto read_event = decode(event.wire);
    const auto read_announcement = decode(announcement.wire);
    EXPECT_FALSE(read_event && validate(*read_event));
    EXPECT_FALSE(read_announcement && check_task(read_announcement->task));
    refused += static_cast<int>(!read_event) + static_cast<int>(!read_announcement);
  }
  EXPECT_GT(refused, 10 * kCases);
}

}  // namespace
}  // namespace kinship::codec::codec_garbage_test
