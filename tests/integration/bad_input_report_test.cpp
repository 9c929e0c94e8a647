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

void set_placement(kinship_wire_Attempt& attempt, Arena& arena, std::vector<double> numbers) {
  arena.resize(attempt.T_task_base, numbers.size());
  std::copy(numbers.begin(), numbers.end(), attempt.T_task_base._buffer);
}

void set_waypoints(kinship_wire_Attempt& attempt, Arena& arena, std::uint32_t dof,
                   std::size_t numbers) {
  attempt.dof = dof;
  arena.resize(attempt.waypoints, numbers);
}

std::vector<Case> waypoint_cases() {
  return {
      {"NaN in a waypoint",
       [](auto& a, Arena&) { a.waypoints._buffer[9] = kNan; },
       {"waypoint 2", "joint 3", "nan", "finite"}},
      {"infinity in a waypoint",
       [](auto& a, Arena&) { a.waypoints._buffer[0] = -kInfinity; },
       {"waypoint 1", "joint 1", "-inf", "finite"}},
      {"outside the limits",
       [](auto& a, Arena&) { a.waypoints._buffer[7] = 3.5; },
       {"robot 'panda'", "joint 1", "3.5 rad", "2.8973", "waypoint 2"}},
      {"six joints of seven",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 6, 12); },
       {"robot 'panda'", "6 joints", "7"}},
      {"no whole waypoints",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 7, 20); },
       {"waypoints", "20", "dof 7"}},
      {"33 joints",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 33, 66); },
       {"dof", "33", "32"}},
      {"4 000 000 000 joints",
       [](auto& a, Arena&) { a.dof = 4'000'000'000; },
       {"dof", "4e+09", "32"}},
      {"no joints", [](auto& a, Arena&) { a.dof = 0; }, {"dof", "0", "1"}},
      {"one waypoint",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 7, 7); },
       {"waypoints", "1", "2"}},
      {"solved without a path",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 0, 0); },
       {"waypoints", "missing", "solved"}},
      {"a path although not solved",
       [](auto& a, Arena&) { record_of(a).outcome = 1; },
       {"waypoints", "not solved"}},
      {"16 385 waypoints of one joint",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 1, 16385); },
       {"waypoints", "16385", "16384"}},
      {"more bytes than a batch may have",
       [](auto& a, Arena& arena) { set_waypoints(a, arena, 7, 70'000); },
       {"waypoints", "560000", "524288"}},
  };
}

// NOLINTNEXTLINE(readability-function-size): a table
std::vector<Case> record_cases() {
  return {
      {"a placement of 1e300",
       [](auto& a, Arena& arena) {
         set_placement(a, arena, {1e300, 0, 0, 0, 0, 0, 1});
       },
       {"T_task_base", "1e+300", "1000 m"}},
      {"a placement of NaN",
       [](auto& a, Arena& arena) {
         set_placement(a, arena, {0, kNan, 0, 0, 0, 0, 1});
       },
       {"T_task_base", "finite"}},
      {"a zero quaternion",
       [](auto& a, Arena& arena) {
         set_placement(a, arena, {0, 0, 0, 0, 0, 0, 0});
       },
       {"T_task_base", "quaternion", "0"}},
      {"a placement of six numbers",
       [](auto& a, Arena& arena) {
         set_placement(a, arena, {0, 0, 0, 0, 0, 0});
       },
       {"T_task_base", "6", "7"}},
      {"an empty task", [](auto& a, Arena& arena) { a.task = arena.text(""); }, {"task", "empty"}},
      {"a task with a line feed",
       [](auto& a, Arena& arena) { a.task = arena.text("a\nb"); },
       {"task", "byte 2", "A-Z"}},
      {"a task of 129 bytes",
       [](auto& a, Arena& arena) { a.task = arena.text(std::string(129, 't')); },
       {"task", "129", "128"}},
      {"a task of a million bytes",
       [](auto& a, Arena& arena) { a.task = arena.text(std::string(1'000'000, 't')); },
       {"task", "1000000", "128"}},
      {"a machine that is not UTF-8",
       [](auto& a, Arena& arena) { a.machine = arena.text("cell \xC3("); },
       {"machine", "UTF-8"}},
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
      {"a share of 1.5", [](auto& a, Arena&) { record_of(a).share = 1.5; }, {"share", "1.5", "1"}},
      {"a share of NaN",
       [](auto& a, Arena&) { record_of(a).share = kNan; },
       {"share", "nan", "0", "1"}},
      {"negative planning time",
       [](auto& a, Arena&) { record_of(a).planning_time_s = -1; },
       {"planning_time_s", "-1", "negative"}},
      {"an infinite time limit",
       [](auto& a, Arena&) { record_of(a).time_limit_s = kInfinity; },
       {"time_limit_s", "finite"}},
      {"a distribution id of 31 bytes",
       [](auto& a, Arena& arena) { arena.resize(record_of(a).distribution_id, 31); },
       {"distribution_id", "31", "32"}},
      {"a report without UUID",
       [](auto& a, Arena&) { std::fill_n(a.report_uuid, 16, 0); },
       {"report_uuid", "zero"}},
  };
}

kinship_wire_RecordedScene& scene_of(kinship_wire_Attempt& attempt) {
  return attempt.scene._buffer[0];
}

/// Each begins with a scene of a table and a cup, and a can that is held.
std::vector<Case> scene_cases() {
  return {
      {"a size of 0",
       [](auto& a, Arena&) { scene_of(a).objects._buffer[0].size[1] = 0; },
       {"scene", "'table'", "size 0 m", "above 0", "1000 m"}},
      {"a size of NaN",
       [](auto& a, Arena&) { scene_of(a).held._buffer[0].size[0] = kNan; },
       {"scene", "'can'", "size nan m", "1000 m"}},
      {"an infinite size",
       [](auto& a, Arena&) { scene_of(a).objects._buffer[1].size[0] = kInfinity; },
       {"scene", "'cup'", "size inf m", "1000 m"}},
      {"shape 4",
       [](auto& a, Arena&) { scene_of(a).objects._buffer[0].shape = 4; },
       {"scene: shape", "4", "3"}},
      {"a pose 2000 m away",
       [](auto& a, Arena&) { scene_of(a).objects._buffer[0].pose[2] = 2000; },
       {"scene", "'table'", "pose", "2000", "1000 m"}},
      {"a pose without rotation",
       [](auto& a, Arena&) { scene_of(a).held._buffer[0].pose[6] = 0; },
       {"scene", "'can'", "pose", "quaternion"}},
      {"a name of 129 bytes",
       [](auto& a, Arena& arena) {
         scene_of(a).objects._buffer[0].name = arena.text(std::string(129, 'n'));
       },
       {"scene", "name", "129", "128"}},
      {"no name",
       [](auto& a, Arena&) { scene_of(a).objects._buffer[0].name = nullptr; },
       {"scene", "name", "empty"}},
      {"a name that is not UTF-8",
       [](auto& a, Arena& arena) { scene_of(a).held._buffer[0].name = arena.text("\xC3("); },
       {"scene", "name", "UTF-8"}},
      {"a pair with a link",
       [](auto& a, Arena& arena) {
         scene_of(a).allowed_collisions._buffer[0].first = arena.text("panda_hand");
       },
       {"allowed_collisions", "'panda_hand'", "neither an object nor held"}},
      {"more bytes than a scene may have",
       [](auto& a, Arena& arena) {
         char* const name = arena.text(std::string(100, 'n'));
         arena.resize(scene_of(a).objects, 2000);
         for (std::size_t i = 0; i < 2000; ++i)
           scene_of(a).objects._buffer[i] = {name, 0, {1, 1, 1}, {0, 0, 0, 0, 0, 0, 1}, false};
       },
       {"scenes of a batch", "392", "262144"}},
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

  void expect_refusals(const std::vector<Case>& cases) {
    for (const Case& bad : cases) {
      SCOPED_TRACE(bad.name);
      const std::vector<Receipt> receipts = receipts_of(bad.damage);
      ASSERT_EQ(receipts.size(), 1U);
      EXPECT_EQ(receipts[0].status, ReceiptStatus::Refused);
      expect_words(receipts[0].message, bad.words);
    }
    expect_untouched();
  }

  RawConversation<codec::ReportConversation> report_{participant_};
};

TEST_F(BadReport, WaypointsThatNoRobotCanHaveAreRefused) { expect_refusals(waypoint_cases()); }

TEST_F(BadReport, RecordsThatCannotBeAreRefused) { expect_refusals(record_cases()); }

TEST_F(BadReport, ScenesThatCannotBeAreRefused) { expect_refusals(scene_cases()); }

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
