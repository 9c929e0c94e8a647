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

  void spoil(kinship_wire_Attempt& w) {
    one_of(w.machine, w.task, w.T_task_base, w.dof, w.waypoints, w.scene, w.scene, w.record,
           w.record, w.search, w.search);
  }
  void spoil(kinship_wire_RecordedScene& w) {
    one_of(w.objects, w.held, w.allowed_collisions, w.constraint);
  }
  void spoil(kinship_wire_SearchRecord& w) {
    one_of(w.dof, w.start, w.goals, w.T_task_goal, w.blockers, w.goal_contacts, w.last_free,
           w.trees, w.trees, w.reason);
  }
  void spoil(kinship_wire_Blocker& w) { one_of(w.first, w.second, w.count); }
  void spoil(kinship_wire_GoalContact& w) { one_of(w.goal, w.first, w.second); }
  void spoil(kinship_wire_SearchTree& w) { one_of(w.configurations, w.parents); }
  void spoil(kinship_wire_SceneSolid& w) { one_of(w.name, w.shape, w.size, w.pose); }
  void spoil(kinship_wire_SolidPair& w) { one_of(w.first, w.second); }
  void spoil(kinship_wire_TaskSpaceRegion& w) { one_of(w.T_task_region, w.T_region_end, w.bounds); }
  void spoil(kinship_wire_Rehearsal& w) { one_of(w.guide, w.processor_time_s, w.costs, w.message); }
  void spoil(kinship_wire_GuideCost& w) {
    one_of(w.guide, w.solved, w.mean_checks, w.median_checks, w.mean_time_s);
  }
  void spoil(kinship_wire_RecallLibrary& w) {
    one_of(w.search_checks, w.try_checks, w.anchors, w.queries, w.queries, w.paths, w.paths,
           w.modes, w.solves, w.reaches);
  }
  void spoil(kinship_wire_RecallQuery& w) {
    one_of(w.T_task_base, w.start, w.goal, w.T_task_anchors);
  }
  void spoil(kinship_wire_RecallPath& w) { one_of(w.query, w.waypoints); }
  void spoil(kinship_wire_WarpMode& w) { one_of(w.blend, w.frame); }
  void spoil(kinship_wire_PlanningRecord& w) {
    one_of(w.outcome, w.planner, w.planner_options, w.planning_time_s, w.sampling_mode, w.share,
           w.distribution_id);
  }
  void spoil(kinship_wire_Selection& w) { one_of(w.sources, w.weighting, w.since_ms); }
  void spoil(kinship_wire_ArmEvidence& w) { one_of(w.solved, w.checks_per_solution); }
  void spoil(kinship_wire_JudgedAttempt& w) { one_of(w.sampling_mode, w.age); }
  void spoil(kinship_wire_Source& w) { one_of(w.label, w.relation, w.mass); }
  void spoil(kinship_wire_Event& w) { one_of(w.kind, w.task, w.robot, w.text); }
  void spoil(kinship_wire_Announcement& w) { one_of(w.task); }
  void spoil(kinship_wire_FitOrigin& w) { one_of(w.reason); }
  void spoil(kinship_wire_ComponentScore& w) { one_of(w.components, w.score); }
  void spoil(kinship_wire_JointCut& w) { one_of(w.joint, w.angle); }
  void spoil(kinship_wire_Kernels& w) { one_of(w.weights, w.covariance); }
  void spoil(kinship_wire_Mixture& w) { one_of(w.weights, w.means, w.covariances); }
  void spoil(kinship_wire_Distribution& w) {
    one_of(w.task, w.T_task_base, w.state, w.limits, w.held_out_score, w.recommended_share,
           w.evidence, w.mixture, w.kernels, w.mixture, w.kernels, w.selection, w.guided, w.sources,
           w.recent, w.guided_share, w.component_scores, w.cuts, w.fit);
  }

 private:
  template <typename... Members>
  void one_of(Members&... members) {
    int wanted = values_.below(sizeof...(members));
    static_cast<void>(((wanted-- == 0 && (spoil(members), true)) || ...));
  }
  void spoil(char*& text) {
    if (values_.coin())
      text = nullptr;
    for (char* c = text; c && *c != '\0'; ++c)
      if (values_.below(4) == 0)
        *c = static_cast<char>(values_.below(256));
  }
  template <std::floating_point Number>
  void spoil(Number& number) {
    using Limits = std::numeric_limits<Number>;
    constexpr Number kBad[] = {Limits::quiet_NaN(), -1, Limits::max(), -Limits::infinity(), 2};
    number = kBad[values_.below(5)];
  }
  template <std::integral Number>
  void spoil(Number& number) {
    number = static_cast<Number>(values_.generator()() >> static_cast<unsigned>(values_.below(64)));
  }
  template <typename Value, std::size_t N>
  void spoil(Value (&values)[N]) {
    spoil(values[values_.below(N)]);
  }
  /// One of its elements, or it ends early.
  template <typename Sequence>
  requires requires(Sequence& sequence) { sequence._length; }
  void spoil(Sequence& sequence) {
    const auto length = static_cast<int>(sequence._length);
    if (length > 0 && values_.coin())
      return spoil(sequence._buffer[values_.below(length)]);
    sequence._length = static_cast<std::uint32_t>(values_.below(length + 1));
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
    const std::optional<Path>& path = written.attempts[0].path;
    written.attempts[0].search = values.search_record(path ? path->dof() : 7);
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

TEST(CodecGarbage, SpoiledLibraryIsRefusedOrKeepsTheRules) {
  test::RandomValues values(kSeed);
  Vandal vandal(values);
  int refused = 0;
  for (int i = 0; i < 10 * kCases; ++i) {
    FetchReply written;
    written.status = FetchStatus::Pending;
    written.recall = values.recall_library(1 + values.below(8));
    auto message = encode(kHead, written).value_or_throw();
    vandal.spoil(message.wire.recall._buffer[0]);
    const auto read = decode(message.wire);
    if (read)
      EXPECT_FALSE(validate(*read->recall));
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
