#pragma once

#include <gtest/gtest.h>

#include <future>
#include <memory>
#include <stdexcept>
#include <vector>

#include "server/fitting/fit_distribution.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/server/fleet.hpp"

namespace kinship::fitting {

/// A store with three planar robots, and fits of task "shelf" for them.
class FitDistribution : public testing::Test {
 protected:
  FitDistribution() {
    for (const RobotDescription& robot : {fleet::teacher(), fleet::pupil(), fleet::dwarf()})
      registry_.register_robot(robot, 1);
  }

  void report(const std::vector<Attempt>& attempts) {
    std::promise<void> done;
    store_->commit_reports(attempts, [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  }
  static DistributionKey key_of(const runtime::Robot& robot) {
    return {.task = "shelf",
            .robot = robot.digest,
            .T_task_base = std::nullopt,
            .profile = *find_profile("default"),
            .sources = {},
            .since_ms = 0};
  }
  /// For tests that count paths and masses only.
  static DistributionKey quick_key_of(const runtime::Robot& robot) {
    DistributionKey key = key_of(robot);
    key.profile.density.components = 2;
    key.profile.transfer.pose_spacing = 1;
    key.profile.transfer.max_solutions = 1;
    return key;
  }
  FitOutcome fit(const DistributionKey& key) {
    return fit_distribution(key, context_, std::stop_token());
  }
  Distribution fitted(const DistributionKey& key) { return fit(key).distribution.value(); }
  static Source source(const Distribution& distribution, const runtime::Robot& robot) {
    for (const Source& source : distribution.sources)
      if (source.robot == robot.digest)
        return source;
    throw std::logic_error("'" + robot.label + "' is no source");
  }

  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  runtime::RobotRegistry registry_{*store_};
  runtime::Clock clock_;
  FitContext context_{.store = *store_, .robots = registry_, .clock = clock_};
  const runtime::Robot teacher_ = fleet::robot_of(fleet::teacher());
  const runtime::Robot pupil_ = fleet::robot_of(fleet::pupil());
  const runtime::Robot dwarf_ = fleet::robot_of(fleet::dwarf());
};

}  // namespace kinship::fitting
