#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/store/store.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store {

/// Every question that a server asks of a store in its service, about one robot and one task. The
/// store keeps at most kPathsOfAPair paths of them, and few distributions.
class EveryQuestion {
 public:
  static constexpr std::uint64_t kPathsOfAPair = 4;

  /// Runs a question. \param what  names it.
  using Ask = std::function<void(const std::string& what, const std::function<void()>& question)>;

  /// \param robot         registered.
  /// \param first_number  of its reports, 1100 of which are made.
  EveryQuestion(Store& store, const Digest& robot, std::uint64_t first_number, Ask ask)
      : store_(&store), robot_(robot), first_number_(first_number), ask_(std::move(ask)) {}

  void ask_all() {
    ask_("reports", [this] { report(); });
    paths_ = store_->read_paths(robot_, task_, {.after_id = 0, .limit = 10});
    ASSERT_EQ(paths_.size(), kPathsOfAPair);
    ask_("a fit", [this] { fit(); });
    ask_("a fetch", [this] { fetch(); });
    ask_("listings of robots and tasks", [this] { list_names(); });
    ask_("listings", [this] { list(); });
    ask_("what other servers did", [this] { watch(); });
    ask_("another site", [this] { share(); });
    ask_("robots", [this] { change_robots(); });
    ask_("retirement", [this] { retire(); });
  }

 private:
  void report() {
    for (std::uint64_t number = first_number_; number < first_number_ + 40; ++number) {
      Attempt attempt = test::make_attempt(robot_, task_, number);
      if (number % 2 == 0)
        attempt.scene = RecordedScene{{{"table", BoxShape{{1, 1, 0.1}}}}, {}, {}};
      test::report(*store_, {attempt, test::make_unsolved(robot_, task_, 1000 + number)});
      test::report(*store_, {attempt});
    }
  }
  void fit() {
    store_->experience(task_);
    store_->generation(robot_, task_);
    store_->path_ids(robot_, task_);
    store_->attempt_totals(robot_, task_);
    for (const StoredPath& path : store_->read_paths(robot_, task_, {0, 10, 5}))
      if (path.scene_id)
        store_->read_scene(*path.scene_id);
    for (std::uint64_t number = 1; number < 9; ++number)
      store_->put_distribution(test::make_distribution(robot_, task_, number));
    for (const std::uint64_t number : {1U, 2U, 1U})
      store_->put_rehearsal(test::make_rehearsal(robot_, task_, number), {.count = 1});
    store_->read_rehearsals(10);
  }
  void fetch() {
    EXPECT_TRUE(store_->find_distribution(test::id_from<Digest>(8)));
    store_->note_use(test::id_from<Digest>(8));
    store_->find_robot(robot_);
    store_->has_lost(store_->point().token);
  }
  void list_names() {
    store_->robots();
    store_->geometry_revisions();
    store_->list_robots("", 1);
    store_->list_robots("iiwa", 1);
    store_->list_tasks("", 1);
    store_->find_task(task_);
    store_->task_names({.like = task_, .letters = 2, .with_paths = true, .limit = 9});
    store_->list_audit("", "", 2);
    store_->list_audit("anna", "7", 2);
  }
  void list() {
    store_->list_paths(robot_, task_, "", 2);
    store_->list_paths({}, "", "2", 2);
    store_->list_attempts({}, "", "", 2);
    store_->list_attempts(robot_, task_, "", 2);
    store_->find_attempts({}, "", 2);
    store_->find_attempts({.robot = robot_, .task = task_}, "", 2);
    store_->list_distributions({}, "", "", 2);
    store_->list_distributions(robot_, task_, "", 2);
    store_->list_distributions({}, task_, "", 2);
    store_->list_distributions(robot_, "", "", 2);
    store_->find_attempt(paths_[0].report_uuid);
    store_->export_attempts({}, "", "", 2, 1'000'000);
    store_->export_attempts(robot_, task_, "", 2, 1'000'000);
  }
  void watch() {
    const std::optional<StoreChanges> from_now_on = store_->changes_since("");
    if (from_now_on)
      store_->changes_since(from_now_on->cursor);
    const Digest id = test::id_from<Digest>(7);
    const std::optional<FitRight> right = store_->take_fit_right(id);
    ASSERT_TRUE(right);
    store_->put_distribution(test::make_distribution(robot_, task_, 7), *right);
    store_->give_back_fit_right(id, *right);
  }
  void share() {
    store_->list_arrivals("", "", 2);
    const Feed<ArrivedReport> feed = store_->list_arrivals(task_, "", 4);
    ASSERT_EQ(feed.rows.size(), 4U);
    std::vector<Uuid> reports;
    for (const ArrivedReport& each : feed.rows)
      reports.push_back(each.report_uuid);
    store_->list_arrivals(task_, feed.cursor, 2);
    store_->list_retirements("", 2);
    store_->known_reports(reports);
    ReplicatedReports read = store_->read_reports(reports, 1'000'000);
    ASSERT_FALSE(read.reports.empty());
    std::promise<void> done;
    store_->commit_replicated(std::move(read.reports),
                              [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
    store_->retire_reports(std::span(reports).first(1));
    store_->put_notes({{"site/line", "a"}});
    store_->notes("site/");
    store_->put_notes({{"site/line", std::nullopt}});
  }
  void change_robots() {
    const RobotRecord spare = test::make_robot("spare", 77);
    EXPECT_TRUE(store_->register_robot(spare));
    EXPECT_TRUE(store_->register_robot(spare));
    EXPECT_TRUE(store_->remove_robot(spare.digest));
    std::optional<RobotRecord> better = store_->find_robot(robot_);
    ASSERT_TRUE(better);
    ++better->geometry_revision;
    EXPECT_TRUE(store_->replace_geometry(*better));
  }
  void retire() {
    AuditEntry audit;
    audit.verb = "act";
    static_cast<void>(store_->retire_path(paths_[0].report_uuid, &audit));
    static_cast<void>(store_->reset_task(task_, {}, &audit));
    store_->evict_distribution(test::id_from<Digest>(8), &audit);
    static_cast<void>(store_->rename_robot(robot_, "panda_2", &audit));
    static_cast<void>(store_->remove_robot(robot_, {}, &audit));
  }

  Store* store_;
  const Digest robot_;
  const std::string task_ = "shelf";
  const std::uint64_t first_number_;
  const Ask ask_;
  std::vector<StoredPath> paths_;
};

}  // namespace kinship::store
