// What is known of paths while their database is put back to a copy of before.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "server/fitting/pose_path_memory.hpp"
#include "server/store/postgres/postgres_store.hpp"
#include "tests/support/postgres_cluster.hpp"
#include "tests/support/postgres_programs.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/fleet.hpp"

namespace kinship::fitting::pose_path_rollback_test {
namespace {

class PutBack : public testing::Test {
 protected:
  void SetUp() override {
    if (const std::string missing = test::missing_postgres(); !missing.empty())
      GTEST_SKIP() << missing;
    cluster_ = std::make_unique<test::PostgresCluster>();
    url_ = cluster_->create_database("fleet");
    {
      const auto before = open();
      runtime::RobotRegistry(*before).register_robot(fleet::teacher(), 1);
      report(*before, {attempt(1), attempt(2)});
    }
    cluster_->create_database("backup", "fleet");
    store_ = open();
  }
  std::unique_ptr<store::Store> open() const {
    return store::open_postgres_store(url_, {.retry_after = std::chrono::milliseconds(10)});
  }
  Attempt attempt(std::uint64_t number) const {
    Attempt attempt = fleet::solved(teacher_, "shelf", number);
    attempt.report_uuid = test::id_from<Uuid>(number);
    return attempt;
  }
  /// Until it is stored: the first answer may say that the database is gone.
  static void report(store::Store& store, const std::vector<Attempt>& attempts) {
    const auto is_stored = [](ReceiptStatus status) { return status == ReceiptStatus::Stored; };
    while (!std::ranges::all_of(test::statuses(test::report(store, attempts)), is_stored)) {
    }
  }
  void put_back() const {
    cluster_->drop_database("fleet");
    cluster_->create_database("fleet", "backup");
  }
  static std::vector<Uuid> uuids_of(const std::vector<SharedPosePath>& paths) {
    std::vector<Uuid> uuids;
    for (const SharedPosePath& path : paths)
      uuids.push_back(path->path);
    return uuids;
  }
  std::vector<std::int64_t> ids() const {
    return store_->path_ids(teacher_.digest, "shelf", store_->generation(teacher_.digest, "shelf"));
  }

  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  std::unique_ptr<test::PostgresCluster> cluster_;
  std::string url_;
  std::unique_ptr<store::Store> store_;
};

TEST_F(PutBack, PathsThatAreGoneAreNotExperienceAnyMore) {
  runtime::RobotRegistry registry(*store_);
  PosePathMemory memory(*store_, registry);
  const auto read = [&] { return uuids_of(memory.read("shelf", {}, 0, std::stop_token())); };
  report(*store_, {attempt(3), attempt(4)});
  ASSERT_EQ(read(), test::uuids_from({1, 2, 3, 4}));
  const std::vector<std::int64_t> before = ids();
  put_back();
  report(*store_, {attempt(5)});
  ASSERT_EQ(ids().size(), 3U);
  EXPECT_GT(ids().back(), before.back()) << "the number of a path that is gone is another's";
  EXPECT_EQ(read(), test::uuids_from({1, 2, 5}));
  report(*store_, {attempt(4)});  // a client offers it again
  EXPECT_EQ(read(), test::uuids_from({1, 2, 5, 4}));
}

}  // namespace
}  // namespace kinship::fitting::pose_path_rollback_test
