#include <future>

#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

using Statuses = std::vector<ReceiptStatus>;

TEST_P(StoreConformance, AnswersEachAttemptInOrder) {
  Attempt bad = solved(3);
  bad.robot = test::id_from<Digest>(77);
  const std::vector<Receipt> receipts = test::report(
      *store_, {solved(1), test::make_unsolved(panda_.digest, "shelf", 2), bad, solved(4)});
  EXPECT_EQ(test::statuses(receipts),
            (Statuses{ReceiptStatus::Stored, ReceiptStatus::Recorded, ReceiptStatus::UnknownRobot,
                      ReceiptStatus::Stored}));
  EXPECT_EQ(receipts[1].report_uuid, test::id_from<Uuid>(2));
  EXPECT_NE(receipts[2].message.find("not registered"), std::string::npos) << receipts[2].message;
}

TEST_P(StoreConformance, OneUuidForTwoBodiesIsRefusedWhateverDiffers) {
  const Attempt first = solved(1);
  report(first);
  std::vector<Attempt> others(9, first);
  others[0].path = test::make_path(5);
  others[1].task = "table";
  others[2].robot = iiwa_.digest;
  others[3].T_task_base.reset();
  others[4].record.planning_time_s += 1;
  others[5].record.sampling_mode = SamplingMode::Guided;
  others[6].record.distribution_id.reset();
  others[7].record.planner_options += "x";
  others[8] = test::make_unsolved(panda_.digest, "shelf", 1);
  for (const Receipt& receipt : test::report(*store_, others)) {
    EXPECT_EQ(receipt.status, ReceiptStatus::Refused);
    EXPECT_NE(receipt.message.find("another report"), std::string::npos);
  }
  EXPECT_EQ(store_->status().attempts, 1U);
}

TEST_P(StoreConformance, AReportAgainFromAMachineThatIsCalledOtherwiseSinceIsADuplicate) {
  const Attempt first = solved(1);
  report(first);
  Attempt renamed = first;
  renamed.machine = "robot_7";
  EXPECT_EQ(report(renamed), ReceiptStatus::Duplicate);
  EXPECT_EQ(report(first), ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->find_attempt(first.report_uuid)->machine, first.machine);
  renamed.record.planning_time_s += 1;
  EXPECT_EQ(report(renamed), ReceiptStatus::Refused);
}

TEST_P(StoreConformance, TheSameContentAgainIsAnAttemptWithoutASecondPath) {
  report(solved(1));
  Attempt again = solved(2);
  again.path = solved(1).path;
  EXPECT_EQ(report(again), ReceiptStatus::Duplicate);
  EXPECT_EQ(store_->status().attempts, 2U);
  EXPECT_EQ(store_->status().paths, 1U);
  EXPECT_EQ(store_->find_attempt(again.report_uuid)->path->waypoints(), again.path->waypoints());
  EXPECT_EQ(report(again), ReceiptStatus::Duplicate);  // its own retry
  EXPECT_EQ(store_->status().attempts, 2U);
}

TEST_P(StoreConformance, TheSameWaypointsAtAnotherPlacementAreTheirOwnPath) {
  Attempt moved = solved(2);
  moved.T_task_base->translation().x() += 0.5;
  Attempt turned = solved(3);
  turned.T_task_base->rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  Attempt without = solved(4);
  without.T_task_base.reset();
  Attempt identity = solved(5);
  identity.T_task_base = Eigen::Isometry3d::Identity();
  moved.path = turned.path = without.path = identity.path = solved(1).path;
  EXPECT_EQ(test::statuses(test::report(*store_, {solved(1), moved, turned, without, identity})),
            Statuses(5, ReceiptStatus::Stored));
  EXPECT_EQ(store_->status().paths, 5U);
}

TEST_P(StoreConformance, TheSameWaypointsWithinACellOfPlacementsAreOnePath) {
  Attempt again = solved(2);
  again.path = solved(1).path;
  again.T_task_base->translation().x() += 1e-6;  // of the middle of a cell of 1 mm
  EXPECT_EQ(test::statuses(test::report(*store_, {solved(1), again})),
            (Statuses{ReceiptStatus::Stored, ReceiptStatus::Duplicate}));
  EXPECT_FALSE(
      store_->find_attempt(again.report_uuid)->T_task_base->isApprox(test::make_pose(), 0));
}

TEST_P(StoreConformance, RefusesWhatCannotBeKept) {
  Attempt wrong_dof = solved(1);
  wrong_dof.path = test::make_path(1, test::kDof + 1);
  Attempt counter = solved(4);
  counter.record.collision_checks = ~std::uint64_t{0};
  const std::vector<Receipt> receipts = test::report(*store_, {wrong_dof, counter, solved(6)});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(receipts[i].status, ReceiptStatus::Refused) << i;
    EXPECT_FALSE(receipts[i].message.empty()) << i;
  }
  EXPECT_EQ(receipts[2].status, ReceiptStatus::Stored);
  EXPECT_EQ(store_->status().attempts, 1U);  // nothing of the refused ones is left
  EXPECT_EQ(store_->status().paths, 1U);
}

TEST_P(StoreConformance, GivesAnAttemptBackAsItWas) {
  const Attempt before = solved(1);
  report(before);
  const std::optional<Attempt> after = store_->find_attempt(before.report_uuid);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->report_uuid, before.report_uuid);
  EXPECT_EQ(after->robot, before.robot);
  EXPECT_EQ(after->machine, before.machine);
  EXPECT_EQ(after->task, before.task);
  EXPECT_TRUE(after->T_task_base->isApprox(*before.T_task_base, 1e-15));
  EXPECT_EQ(after->record.outcome, Outcome::Solved);
  EXPECT_EQ(after->record.planner, "birrt");
  EXPECT_EQ(after->record.planner_options, "step=0.1");
  EXPECT_EQ(after->record.planning_time_s, 0.25);
  EXPECT_EQ(after->record.collision_checks, 1234U);
  EXPECT_EQ(after->record.projections, 5U);
  EXPECT_EQ(after->record.time_limit_s, 10);
  EXPECT_EQ(after->record.sampling_mode, SamplingMode::Control);
  EXPECT_EQ(after->record.share, 0.5);
  EXPECT_EQ(after->record.distribution_id, before.record.distribution_id);
  EXPECT_EQ(after->record.distribution_revision, 7U);
  EXPECT_EQ(after->path->waypoints(), before.path->waypoints());
  EXPECT_FALSE(store_->find_attempt(test::id_from<Uuid>(50)));
}

TEST_P(StoreConformance, KeepsWhatIsMissingMissing) {
  Attempt before = test::make_unsolved(panda_.digest, "shelf", 1);
  before.T_task_base.reset();
  before.record.distribution_id.reset();
  before.record.outcome = Outcome::Failed;
  report(before);
  const std::optional<Attempt> after = store_->find_attempt(before.report_uuid);
  ASSERT_TRUE(after);
  EXPECT_FALSE(after->T_task_base || after->record.distribution_id || after->path);
  EXPECT_EQ(after->record.outcome, Outcome::Failed);
}

TEST_P(StoreConformance, ReadsPathsInTheOrderOfArrivalAndOnFromAnId) {
  for (std::uint64_t i = 1; i <= 5; ++i)
    report(solved(i));
  const std::vector<StoredPath> all =
      store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 100});
  ASSERT_EQ(all.size(), 5U);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].report_uuid, test::id_from<Uuid>(i + 1));
    EXPECT_EQ(all[i].path.waypoints(), test::make_path(i + 1).waypoints());
    EXPECT_TRUE(all[i].T_task_base->isApprox(test::make_pose(), 1e-15));
    EXPECT_GT(all[i].id, i == 0 ? 0 : all[i - 1].id);
  }
  const auto some = store_->read_paths(panda_.digest, "shelf", {.after_id = all[1].id, .limit = 2});
  ASSERT_EQ(some.size(), 2U);
  EXPECT_EQ(some[0].id, all[2].id);
  EXPECT_TRUE(
      store_->read_paths(panda_.digest, "shelf", {.after_id = all[4].id, .limit = 2}).empty());
  EXPECT_TRUE(store_->read_paths(iiwa_.digest, "shelf", {.after_id = 0, .limit = 100}).empty());
  EXPECT_TRUE(store_->read_paths(panda_.digest, "table", {.after_id = 0, .limit = 100}).empty());
}

TEST_P(StoreConformance, AnswersEveryClientOfMany) {
  constexpr std::uint64_t kClients = 8;
  constexpr std::uint64_t kReports = 50;
  std::vector<std::future<int>> clients;
  for (std::uint64_t client = 0; client < kClients; ++client)
    clients.push_back(std::async(std::launch::async, [this, client] {
      int stored = 0;
      for (std::uint64_t i = 0; i < kReports; ++i) {
        if (report(solved(1000 * (client + 1) + i)) == ReceiptStatus::Stored)
          ++stored;
        store_->read_paths(panda_.digest, "shelf", {.after_id = 0, .limit = 5});
      }
      return stored;
    }));
  for (std::future<int>& client : clients)
    EXPECT_EQ(client.get(), kReports);
  EXPECT_EQ(store_->status().paths, kClients * kReports);
  EXPECT_EQ(store_->status().queued, 0U);
}

}  // namespace
}  // namespace kinship::store
