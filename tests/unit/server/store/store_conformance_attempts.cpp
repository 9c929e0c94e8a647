#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kManyBytes = 1'000'000;

/// Its numbers are those of the attempts made for them.
class Exported {
 public:
  explicit Exported(const Store& store) : store_(&store) {}

  std::vector<Uuid> uuids(const std::optional<Digest>& robot, std::string_view task,
                          std::size_t limit, std::size_t max_bytes = kManyBytes) {
    std::vector<Uuid> uuids;
    std::string cursor;
    pages_ = 0;
    do {
      const Page<Attempt> page = store_->export_attempts(robot, task, cursor, limit, max_bytes);
      EXPECT_TRUE(!page.rows.empty() || page.next_cursor.empty());
      EXPECT_LE(page.rows.size(), limit);
      for (const Attempt& attempt : page.rows)
        uuids.push_back(attempt.report_uuid);
      cursor = page.next_cursor;
      ++pages_;
    } while (!cursor.empty());
    return uuids;
  }
  std::size_t pages() const { return pages_; }

 private:
  const Store* store_;
  std::size_t pages_ = 0;
};

TEST_P(StoreConformance, ExportsAttemptsOldestFirstUnderEveryFilter) {
  report(solved(1));
  report(test::make_attempt(iiwa_.digest, "table", 2));
  report(test::make_unsolved(panda_.digest, "table", 3));
  report(test::make_attempt(iiwa_.digest, "shelf", 4));
  report(solved(5));
  Exported exported(*store_);
  for (const std::size_t limit : {1U, 2U, 100U}) {
    EXPECT_EQ(exported.uuids({}, "", limit), test::uuids_from({1, 2, 3, 4, 5}));
    EXPECT_EQ(exported.uuids({}, "shelf", limit), test::uuids_from({1, 4, 5}));
    EXPECT_EQ(exported.uuids(panda_.digest, "", limit), test::uuids_from({1, 3, 5}));
    EXPECT_EQ(exported.uuids(iiwa_.digest, "table", limit), test::uuids_from({2}));
    EXPECT_TRUE(exported.uuids({}, "nothing", limit).empty());
  }
}

TEST_P(StoreConformance, ExportsManyAttemptsOnceEach) {
  std::vector<Attempt> attempts;
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t i = 1; i <= 300; ++i) {
    attempts.push_back(test::make_attempt(i % 2 == 0 ? panda_.digest : iiwa_.digest, "shelf", i));
    numbers.push_back(i);
  }
  test::report(*store_, std::move(attempts));
  EXPECT_EQ(Exported(*store_).uuids({}, "shelf", 7), test::uuids_from(numbers));
  EXPECT_EQ(Exported(*store_).uuids({}, "", 1000), test::uuids_from(numbers));
}

TEST_P(StoreConformance, ExportsWhatItTookWithItsPath) {
  const Attempt before = solved(1);
  report(before);
  const Attempt after = store_->export_attempts({}, "", "", 10, kManyBytes).rows.at(0);
  EXPECT_EQ(after.robot, before.robot);
  EXPECT_EQ(after.machine, before.machine);
  EXPECT_EQ(after.record.collision_checks, before.record.collision_checks);
  EXPECT_EQ(after.path->waypoints(), before.path->waypoints());
  EXPECT_EQ(report(after), ReceiptStatus::Duplicate);  // what was exported is the same report
}

TEST_P(StoreConformance, ExportsNoRetiredPathAndNoReportOfItsContent) {
  Attempt same = solved(2);
  same.path = solved(1).path;
  test::report(*store_, {solved(1), same, solved(3)});
  ASSERT_TRUE(store_->retire_path(solved(1).report_uuid));
  Exported exported(*store_);
  EXPECT_EQ(exported.uuids({}, "", 1), test::uuids_from({3}));
  EXPECT_EQ(exported.uuids({}, "shelf", 10), test::uuids_from({3}));
}

TEST_P(StoreConformance, APageOfAnExportEndsBeforeItsBytesAreExceeded) {
  constexpr std::size_t kPathBytes = std::size_t{8} * test::kDof * 20;
  for (std::uint64_t i = 1; i <= 6; ++i)
    report(solved(i));
  Exported exported(*store_);
  EXPECT_EQ(exported.uuids({}, "", 100, 2 * kPathBytes).size(), 6U);
  EXPECT_EQ(exported.pages(), 3U);
  EXPECT_EQ(exported.uuids({}, "", 100, 1).size(), 6U);  // one at least
  EXPECT_EQ(exported.pages(), 6U);
}

TEST_P(StoreConformance, AnExportRefusesACursorOfSomethingElse) {
  report(solved(1));
  for (const char* const cursor : {"x", "1.2.3", "-1", "1 ", "99999999999999999999"})
    EXPECT_THROW(store_->export_attempts({}, "", cursor, 10, kManyBytes), Failure) << cursor;
}

TEST_P(StoreConformance, SumsUpWhatTheArmsOfARobotAndTaskCost) {
  const auto attempt = [this](std::uint64_t number, SamplingMode mode, std::uint64_t checks,
                              bool is_solved) {
    Attempt made = is_solved ? solved(number) : test::make_unsolved(panda_.digest, "shelf", number);
    made.record.sampling_mode = mode;
    made.record.collision_checks = checks;
    return made;
  };
  test::report(
      *store_,
      {attempt(1, SamplingMode::Guided, 10, true), attempt(2, SamplingMode::Guided, 30, false),
       attempt(3, SamplingMode::Control, 100, true), attempt(4, SamplingMode::Uniform, 7, true)});
  test::report(*store_, {attempt(5, SamplingMode::Guided, 20, true),
                         attempt(1, SamplingMode::Guided, 10, true)});
  Attempt elsewhere = attempt(6, SamplingMode::Guided, 1000, true);
  elsewhere.task = "table";
  report(elsewhere);
  reopen();
  const AttemptTotals totals = store_->attempt_totals(panda_.digest, "shelf");
  EXPECT_EQ(totals.guided.attempts, 3U);
  EXPECT_EQ(totals.guided.solved, 2U);
  EXPECT_EQ(totals.guided.checks, 60);
  EXPECT_EQ(totals.guided.checks_squared, 1400);
  EXPECT_EQ(totals.guided.checks_of_solved, 30);
  EXPECT_EQ(totals.control.attempts, 1U);
  EXPECT_EQ(totals.control.solved, 1U);
  EXPECT_EQ(totals.control.checks, 100);
  EXPECT_EQ(totals.control.checks_squared, 10'000);
  EXPECT_EQ(totals.control.checks_of_solved, 100);
  EXPECT_EQ(store_->attempt_totals(panda_.digest, "table").guided.checks, 1000);
  EXPECT_EQ(store_->attempt_totals(iiwa_.digest, "shelf").guided.attempts, 0U);
  EXPECT_EQ(store_->attempt_totals(panda_.digest, "nothing").control.attempts, 0U);
}

TEST_P(StoreConformance, MeansAreOfSolvedAttemptsThatWereMeasuredInEachMode) {
  const auto attempt = [this](std::uint64_t number, SamplingMode mode, double factor) {
    Attempt made = solved(number);
    made.record.sampling_mode = mode;
    made.record.processor_time_s = 0.25 * factor;
    made.record.machine_speed = 2;
    made.record.hand_length_m = factor;
    made.record.least_clearance_m = 0.01 * factor;
    return made;
  };
  const auto mean_of = [](const Attempt& first, const Attempt& second) {
    const auto length = [](const Attempt& attempt) {
      const Eigen::MatrixXd& q = attempt.path->waypoints();
      return (q.rightCols(q.cols() - 1) - q.leftCols(q.cols() - 1)).colwise().norm().sum();
    };
    return (length(first) + length(second)) / 2;
  };
  EXPECT_FALSE(store_->status().guided_means);
  const Attempt first = attempt(1, SamplingMode::Guided, 1),
                second = attempt(2, SamplingMode::Guided, 3);
  Attempt unmeasured = attempt(3, SamplingMode::Guided, 100);
  unmeasured.record.hand_length_m = 0;
  Attempt untimed = attempt(4, SamplingMode::Guided, 100);
  untimed.record.processor_time_s = 0;
  Attempt unsolved = test::make_unsolved(panda_.digest, "shelf", 5);
  unsolved.record.sampling_mode = SamplingMode::Guided;
  Attempt elsewhere = attempt(7, SamplingMode::Guided, 5);
  elsewhere.task = "table";
  test::report(*store_, {first, unmeasured, untimed, unsolved});
  test::report(*store_, {second, attempt(6, SamplingMode::Uniform, 100),
                         attempt(8, SamplingMode::Control, 7), elsewhere, first});
  reopen();
  const TaskRobotSummary pair = store_->find_task("shelf")->robots.at(0);
  ASSERT_TRUE(pair.guided_means);
  EXPECT_EQ(pair.guided_means->attempts, 2U);
  EXPECT_DOUBLE_EQ(pair.guided_means->time_s, 1);
  EXPECT_DOUBLE_EQ(pair.guided_means->length, mean_of(first, second));
  EXPECT_DOUBLE_EQ(pair.guided_means->hand_length_m, 2);
  EXPECT_DOUBLE_EQ(pair.guided_means->least_clearance_m, 0.02);
  ASSERT_TRUE(pair.control_means);
  EXPECT_EQ(pair.control_means->attempts, 1U);
  EXPECT_DOUBLE_EQ(pair.control_means->time_s, 3.5);
  EXPECT_DOUBLE_EQ(pair.control_means->hand_length_m, 7);
  EXPECT_DOUBLE_EQ(pair.control_means->least_clearance_m, 0.07);
  const StoreStatus status = store_->status();
  ASSERT_TRUE(status.guided_means);
  EXPECT_EQ(status.guided_means->attempts, 3U);
  EXPECT_DOUBLE_EQ(status.guided_means->hand_length_m, 3);
  ASSERT_TRUE(status.control_means);
  EXPECT_DOUBLE_EQ(status.control_means->least_clearance_m, 0.07);
  EXPECT_EQ(store_->export_attempts({}, "table", "", 1, kManyBytes).rows.at(0).record.hand_length_m,
            5);
}

TEST_P(StoreConformance, TheNewestJudgedAttemptsComeOldestFirstWithTheirAge) {
  const Digest distribution = test::id_from<Digest>(99);
  const auto attempt = [this, distribution](std::uint64_t number, SamplingMode mode,
                                            Outcome outcome) {
    Attempt made = outcome == Outcome::Solved ? solved(number)
                                              : test::make_unsolved(panda_.digest, "shelf", number);
    made.record.sampling_mode = mode;
    made.record.outcome = outcome;
    made.record.collision_checks = number;
    made.record.planner = number == 5 ? "rrtc" : "birrt";
    made.record.distribution_id.reset();
    made.record.processor_time_s = 0.25;
    if (number == 5) {
      made.record.distribution_id = distribution;
      made.record.machine_speed = 3;
    }
    return made;
  };
  test::report(*store_, {attempt(1, SamplingMode::Control, Outcome::Solved),
                         attempt(2, SamplingMode::Guided, Outcome::Timeout),
                         attempt(3, SamplingMode::Uniform, Outcome::Solved),
                         attempt(4, SamplingMode::Guided, Outcome::Failed),
                         attempt(5, SamplingMode::Guided, Outcome::Solved)});
  reopen();
  EXPECT_EQ(
      store_->attempt_totals(panda_.digest, "shelf").recent,
      (std::vector<KnownAttempt>{{{SamplingMode::Control, true, 1, 2}, "birrt", {}},
                                 {{SamplingMode::Guided, false, 2, 1}, "birrt", {}},
                                 {{SamplingMode::Guided, true, 5, 0, 0.75}, "rrtc", distribution}}))
      << "a time counts with the speed of its machine alone";
  EXPECT_TRUE(store_->attempt_totals(iiwa_.digest, "shelf").recent.empty());
}

TEST_P(StoreConformance, OfEachArmAsManyJudgedAttemptsAsCountAreRead) {
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < kKnownAttemptsPerMode + 10; ++i) {
    attempts.push_back(test::make_unsolved(panda_.digest, "shelf", i + 1));
    attempts.back().record.sampling_mode = i == 0 ? SamplingMode::Control : SamplingMode::Guided;
    attempts.back().record.outcome = Outcome::Timeout;
    attempts.back().record.collision_checks = i;
  }
  test::report(*store_, attempts);
  const std::vector<KnownAttempt> recent = store_->attempt_totals(panda_.digest, "shelf").recent;
  ASSERT_EQ(recent.size(), kKnownAttemptsPerMode + 1);
  EXPECT_EQ(recent[0].judged,
            (JudgedAttempt{SamplingMode::Control, false, 0, kKnownAttemptsPerMode + 9}));
  EXPECT_EQ(recent[1].judged.checks, 10U);
  EXPECT_EQ(recent[1].judged.age, kKnownAttemptsPerMode - 1);
}

}  // namespace
}  // namespace kinship::store
