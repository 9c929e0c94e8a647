// Reports that no client of ours would send, put onto the wire past its checks: a real kinshipd
// refuses each with the thing, the value and the limit, stores nothing and goes on.

#include <functional>
#include <limits>

#include "tests/support/bad_input_test.hpp"
#include "tests/support/panda_experience.hpp"

namespace kinship::test::bad_input_report_test {
namespace {

using codec::Arena;
using Damage = std::function<void(kinship_wire_Attempt&, Arena&)>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Case {
  const char* name;
  Damage damage;
  std::vector<std::string> words;  // of the refusal
};

kinship_wire_PlanningRecord& record_of(kinship_wire_Attempt& attempt) {
  return attempt.record._buffer[0];
}

void set_waypoints(kinship_wire_Attempt& attempt, Arena& arena, std::uint32_t dof,
                   std::size_t numbers) {
  attempt.dof = dof;
  arena.resize(attempt.waypoints, numbers);
}

/// What the decoder refuses is held row by row in report_codec_test; here are some of each kind.
std::vector<Case> cases() {
  return {
      {"infinity in a waypoint",
       [](auto& a, Arena&) { a.waypoints._buffer[0] = -kInfinity; },
       {"waypoint 1", "joint 1", "-inf", "finite"}},
      {"outside the limits",
       [](auto& a, Arena&) { a.waypoints._buffer[7] = 3.5; },
       {"robot 'panda'", "joint 1", "3.5 rad", "2.8973", "waypoint 2"}},
      {"six joints of seven",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 6, 12); },
       {"robot 'panda'", "6 joints", "7"}},
      {"4 000 000 000 joints",
       [](auto& a, Arena&) { a.dof = 4'000'000'000; },
       {"dof", "4e+09", "32"}},
      {"more bytes than a batch may have",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 7, 70'000); },
       {"waypoints", "560000", "524288"}},
      {"a task of a million bytes",
       [](auto& a, Arena& arena) { a.task = arena.text(std::string(1'000'000, 't')); },
       {"task", "1000000", "128"}},
      {"a machine with an escape",
       [](auto& a, Arena& arena) { a.machine = arena.text("\x1B[2J"); },
       {"machine", "control character"}},
      {"planner options of 1025 bytes",
       [](auto& a, Arena& arena) {
         record_of(a).planner_options = arena.text(std::string(1025, 'o'));
       },
       {"planner_options", "1025", "1024"}},
      {"outcome 7", [](auto& a, Arena&) { record_of(a).outcome = 7; }, {"outcome", "7", "2"}},
      {"sampling mode 2^32 - 1",
       [](auto& a, Arena&) { record_of(a).sampling_mode = 0xFFFFFFFF; },
       {"sampling_mode", "4294967295", "2"}},
      {"negative planning time",
       [](auto& a, Arena&) { record_of(a).planning_time_s = -1; },
       {"planning_time_s", "-1", "negative"}},
      {"a distribution id of 31 bytes",
       [](auto& a, Arena& arena) { arena.resize(record_of(a).distribution_id, 31); },
       {"distribution_id", "31", "32"}},
      {"an object of a scene of size 0",
       [](auto& a, Arena&) { a.scene._buffer[0].objects._buffer[0].size[1] = 0; },
       {"scene", "'table'", "size 0 m", "above 0", "1000 m"}},
      {"a name of an object that is not there",
       [](auto& a, Arena&) { a.scene._buffer[0].objects._buffer[0].name = nullptr; },
       {"scene", "name", "empty"}},
  };
}

class BadReport : public BadInput {
 protected:
  /// The receipts of a batch in which `damage` was done to the first attempt.
  std::vector<Receipt> receipts_of(const Damage& damage, std::uint64_t attempts = 1,
                                   std::chrono::milliseconds patience = std::chrono::seconds(60)) {
    ReportRequest request;
    for (std::uint64_t i = 0; i < attempts; ++i) {
      request.attempts.push_back(panda_attempt(panda_, "sweep", i));
      request.attempts.back().scene =
          RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}}, {"cup", CylinderShape{0.04, 0.1}}},
                        {{"can", SphereShape{0.05}}},
                        {{"can", "table"}}};
    }
    auto message = codec::encode({}, request).value_or_throw();
    damage(message.wire.attempts._buffer[0], *message.arena);
    const auto reply = report_.call(message.wire, patience);
    return reply ? reply->receipts : std::vector<Receipt>{};
  }

  RawConversation<codec::ReportConversation> report_{participant_};
};

TEST_F(BadReport, ThatCannotBeIsRefused) {
  for (const Case& bad : cases()) {
    SCOPED_TRACE(bad.name);
    const std::vector<Receipt> receipts = receipts_of(bad.damage);
    ASSERT_EQ(receipts.size(), 1U);
    EXPECT_EQ(receipts[0].status, ReceiptStatus::Refused);
    expect_words(receipts[0].message, bad.words);
  }
  expect_untouched();
}

TEST_F(BadReport, OfAnUnknownRobotWaitsAndNamesIt) {
  const auto receipts =
      receipts_of([](kinship_wire_Attempt& attempt, Arena&) { attempt.robot[0] ^= 1; });
  ASSERT_EQ(receipts.size(), 1U);
  EXPECT_EQ(receipts[0].status, ReceiptStatus::UnknownRobot);
  Digest unknown = panda_;
  unknown.bytes[0] ^= 1;
  expect_words(receipts[0].message, {unknown.short_hex(), "not known"});
  expect_untouched();
}

TEST_F(BadReport, CostsItsNeighboursInTheBatchNothing) {
  const auto receipts = receipts_of(
      [](kinship_wire_Attempt& attempt, Arena&) { attempt.waypoints._buffer[3] = kNan; }, 3);
  ASSERT_EQ(receipts.size(), 3U);
  EXPECT_EQ(std::count_if(receipts.begin(), receipts.end(),
                          [](const Receipt& r) { return r.status == ReceiptStatus::Stored; }),
            2);
  EXPECT_EQ(status().paths, 2U);
}

TEST_F(BadReport, ABatchOfMoreThanItsIdlAllowsIsDroppedAndTheNextOneAnswered) {
  ReportRequest request;
  request.attempts.push_back(panda_attempt(panda_, "sweep", 1));
  auto message = codec::encode({}, request).value_or_throw();
  const kinship_wire_Attempt attempt = message.wire.attempts._buffer[0];
  message.arena->resize(message.wire.attempts, 257);
  std::fill_n(message.wire.attempts._buffer, 257, attempt);
  EXPECT_FALSE(report_.call(message.wire, std::chrono::seconds(3)));
  expect_untouched();
}

TEST_F(BadReport, AMillionWaypointsAreRefusedByTheClientAndDroppedByTheServer) {
  Attempt attempt = panda_attempt(panda_, "sweep", 1);
  attempt.path = Path(Eigen::MatrixXd::Zero(7, 1'000'000));
  try {
    client_.report(attempt);
    ADD_FAILURE() << "not refused";
  } catch (const Failure& failure) {
    expect_words(failure.error().message, {"waypoints", "1000000", "16384"});
  }
  const Damage million = [](auto& wire, Arena& arena) { set_waypoints(wire, arena, 7, 7'000'000); };
  EXPECT_TRUE(receipts_of(million, 1, std::chrono::seconds(3)).empty());
  expect_untouched();
}

}  // namespace
}  // namespace kinship::test::bad_input_report_test
