#pragma once

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <string>
#include <vector>

#include "server/catalog/experience_index.hpp"
#include "server/rehearsal/rehearse.hpp"
#include "server/runtime/clock.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::rehearsal {

/// A store in which a Panda swept past a post, and a UR10e that never did.
class RehearsalTest : public testing::Test {
 protected:
  RehearsalTest() {
    for (const char* const robot : {"panda", "ur10e"})
      registry_.register_robot(test::model_description(robot), 1);
  }

  /// \param T_task_base  in front of which it stands.
  static RecordedScene post(const Eigen::Isometry3d& T_task_base = Eigen::Isometry3d::Identity()) {
    RecordedScene scene;
    scene.objects.push_back(
        {"post", BoxShape{{0.08, 0.08, 1.2}}, T_task_base * Eigen::Translation3d(0.62, 0, 0.6)});
    return scene;
  }
  /// \return the reports, in their order.
  std::vector<Attempt> report_sweeps(
      std::size_t count, const std::optional<RecordedScene>& scene = post(),
      const std::optional<Eigen::Isometry3d>& T_task_base = std::nullopt) {
    std::vector<Attempt> attempts;
    for (std::size_t i = 0; i < count; ++i) {
      attempts.push_back(test::panda_attempt(panda_, "sweep", next_seed_++));
      attempts.back().record.planner_options = "step=0.1 overshoot=1 max_checks=100000";
      attempts.back().scene = scene;
      attempts.back().T_task_base = T_task_base;
    }
    std::promise<void> done;
    store_->commit_reports(attempts, [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
    return attempts;
  }

  fitting::DistributionKey key_of(
      const Digest& robot,
      const std::optional<Eigen::Isometry3d>& T_task_base = std::nullopt) const {
    fitting::DistributionKey key{.task = "sweep",
                                 .robot = robot,
                                 .T_task_base = T_task_base,
                                 .profile = *find_profile("default"),
                                 .sources = {},
                                 .since_ms = 0};
    key.profile.density.components = 2;
    return key;
  }
  RecordedQueries queries_for(const Digest& robot, std::size_t most = 100) {
    return read_queries(*store_, registry_, key_of(robot), most, {});
  }
  std::shared_ptr<const runtime::Robot> robot(const Digest& digest) {
    return registry_.find(digest).value_or_throw();
  }

  std::uint64_t next_seed_ = 1;
  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  runtime::RobotRegistry registry_{*store_};
  runtime::Clock clock_;
  const Digest panda_ = test::model_chain("panda").digest();
  const Digest ur10e_ = test::model_chain("ur10e").digest();
};

}  // namespace kinship::rehearsal
