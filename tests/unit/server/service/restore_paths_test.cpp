#include "server/service/restore_paths.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service::restore_paths_test {
namespace {

class RestorePaths : public testing::Test {
 protected:
  RestorePaths() {
    open();
    EXPECT_TRUE(store_->register_robot(robot_));
  }
  void open() {
    store_.reset();
    store_ = store::open_sqlite_store(file_);
  }
  /// Reports of paths that are retired.
  std::vector<Uuid> retired(std::uint64_t count) {
    std::vector<Attempt> attempts;
    std::vector<Uuid> reports;
    for (std::uint64_t number = 1; number <= count; ++number) {
      attempts.push_back(test::make_attempt(robot_.digest, "shelf", number));
      reports.push_back(attempts.back().report_uuid);
    }
    test::report(*store_, std::move(attempts));
    static_cast<void>(store_->reset_task("shelf").value_or_throw());
    return reports;
  }
  /// From now on the database takes no attempt under this UUID, as a rule of its administrator.
  void poison(const Uuid& report) {
    std::string hex = report.text();
    std::erase(hex, '-');
    store_.reset();
    store::Database(file_, store::Access::ReadWrite)
        .execute("CREATE TRIGGER rule BEFORE INSERT ON attempt WHEN NEW.report_uuid = x'" + hex +
                 "' BEGIN SELECT RAISE(ABORT, 'not this one'); END");
    open();
  }
  std::uint64_t paths() const { return store_->find_task("shelf")->paths; }

  const test::TemporaryDirectory directory_;
  const std::filesystem::path file_ = directory_ / "store.db";
  const store::RobotRecord robot_ = test::make_robot("panda", 1);
  std::unique_ptr<store::Store> store_;
};

TEST_F(RestorePaths, AReportThatTheStorePutsOffStandsInNoOnesWay) {
  const std::vector<Uuid> reports = retired(5);
  poison(restored_report(reports[2]));
  for (const std::uint64_t known : {0U, 4U}) {
    Restoration restored;
    restore_paths(*store_, reports, {}, restored);
    EXPECT_EQ(restored.paths, 4U - known);
    EXPECT_EQ(restored.in_use, known);
    EXPECT_EQ(restored.lost, 1U);
    if (known == 0)
      EXPECT_NE(restored.reason.find("not this one"), std::string::npos) << restored.reason;
  }
  EXPECT_EQ(paths(), 4U);
}

TEST_F(RestorePaths, ManyAreStoredAtOnce) {
  constexpr std::uint64_t kPaths = 600;
  const std::vector<Uuid> reports = retired(kPaths);
  store::TroubledStore counting(*store_);
  counting.takes_reports = true;
  Restoration restored;
  restore_paths(counting, reports, {}, restored);
  EXPECT_EQ(restored.paths, kPaths);
  EXPECT_EQ(restored.report_uuid, restored_report(reports[0]));
  EXPECT_EQ(counting.commits, 3U);
  EXPECT_EQ(paths(), kPaths);
}

TEST_F(RestorePaths, AStopEndsItBetweenTwoBatches) {
  constexpr std::uint64_t kPaths = 600, kOfTwoBatches = 512;
  const std::vector<Uuid> reports = retired(kPaths);
  std::stop_source stop;
  store::TroubledStore stopping(*store_);
  stopping.takes_reports = true;
  stopping.on_exchange = [&] {
    if (stopping.commits == 1)  // the second one is read
      stop.request_stop();
  };
  Restoration restored;
  try {
    restore_paths(stopping, reports, stop.get_token(), restored);
    ADD_FAILURE() << "not stopped";
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), ErrorCode::Unavailable);
    EXPECT_NE(std::string(failure.what()).find("stopping after 512 paths"), std::string::npos)
        << failure.what();
  }
  EXPECT_EQ(paths(), kOfTwoBatches);
  restore_paths(*store_, reports, {}, restored);
  EXPECT_EQ(paths(), kPaths);
}

TEST_F(RestorePaths, OneOfWhichACopyWasRetiredTooIsStoredOnce) {
  const std::vector<Uuid> reports = retired(1);
  Restoration first;
  restore_paths(*store_, reports, {}, first);
  ASSERT_EQ(first.paths, 1U);
  static_cast<void>(store_->reset_task("shelf").value_or_throw());
  Restoration both;
  restore_paths(*store_, std::array{reports[0], first.report_uuid}, {}, both);
  EXPECT_EQ(both.paths, 1U);
  EXPECT_EQ(both.in_use, 1U);
  EXPECT_EQ(both.report_uuid, restored_report(first.report_uuid));
  EXPECT_EQ(paths(), 1U);
}

}  // namespace
}  // namespace kinship::service::restore_paths_test
