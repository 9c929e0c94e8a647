// A fit among recorded scenes: what they leave out of another robot's configurations, and what is
// told when they leave nothing.

#include "server/fitting/scene_filters.hpp"

#include <gtest/gtest.h>

#include <future>

#include "server/fitting/fit_distribution.hpp"
#include "server/fitting/source_transfer.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::fitting::scene_filters_test {
namespace {

constexpr std::uint64_t kPaths = 4;

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

const SceneObject kFarAway{"far_away", BoxShape{{1, 1, 1}}, at(50, 0, 0)};
const SceneObject kCeiling{"ceiling", BoxShape{{3, 3, 0.1}}, at(0, 0, 0.95)};
const SceneObject kEverywhere{"everywhere", BoxShape{{0.9, 2, 2}}, at(0.6, 0, 0)};

/// Pandas that swept, a UR10e that asks.
class FitAmongScenes : public testing::Test {
 protected:
  FitAmongScenes() {
    for (const char* const robot : {"panda", "ur10e"})
      registry_.register_robot(test::model_description(robot), 1);
  }

  void report(const std::optional<RecordedScene>& scene) {
    std::vector<Attempt> attempts;
    for (std::uint64_t i = 0; i < kPaths; ++i) {
      attempts.push_back(test::panda_attempt(panda_, "sweep", first_seed_ + i));
      attempts.back().scene = scene;
    }
    std::promise<void> done;
    store_->commit_reports(attempts, [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  }
  DistributionKey key_of(bool avoid) const {
    DistributionKey key{.task = "sweep",
                        .robot = ur10e_,
                        .T_task_base = std::nullopt,
                        .profile = *find_profile("default"),
                        .sources = {},
                        .since_ms = 0};
    key.profile.transfer.avoid_recorded_scene = avoid;
    key.profile.density.components = 2;
    return key;
  }
  Distribution fit(bool avoid = true, int threads = 1) {
    return fit_distribution(
               key_of(avoid),
               {.store = *store_, .robots = registry_, .clock = clock_, .fit_threads = threads}, {})
        .distribution.value();
  }
  /// How many of the configurations that a fit is made of touch a scene.
  std::size_t count_touching(const RecordedScene& scene, bool avoid) {
    const DistributionKey key = key_of(avoid);
    const runtime::RobotRegistry::RobotPointer target = registry_.find(ur10e_).value_or_throw();
    SourceTransfer transfer(*store_, registry_, key, *target);
    transfer_sources(transfer, key, store_->experience(key.task), kPaths, {});
    const transfer::SceneFilter filter = transfer::scene_filter(
        {target->chain, target->shapes}, scene, Eigen::Isometry3d::Identity());
    const Eigen::MatrixXd configurations = transfer.pool().configurations();
    std::size_t touching = 0;
    for (const auto& q : configurations.colwise())
      touching += filter.keep(q) ? 0U : 1U;
    return touching;
  }

  std::uint64_t first_seed_ = 0;
  const test::TemporaryDirectory directory_;
  const std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "s.db");
  runtime::RobotRegistry registry_{*store_};
  runtime::Clock clock_;
  const Digest panda_ = test::model_chain("panda").digest();
  const Digest ur10e_ = test::model_chain("ur10e").digest();
};

TEST_F(FitAmongScenes, WhatWouldTouchASceneIsLeftOutAndCounted) {
  const RecordedScene scene{{kCeiling}, {}, {}};
  report(scene);
  EXPECT_GT(count_touching(scene, false), 0U);
  EXPECT_EQ(count_touching(scene, true), 0U);
  const Source among = fit().sources.at(0), without = fit(false).sources.at(0);
  EXPECT_EQ(among.paths_with_scene, kPaths);
  EXPECT_GT(among.scene_collisions, 0U);
  EXPECT_GT(among.configurations, 0U);
  EXPECT_EQ(without.paths_with_scene, 0U);
  EXPECT_EQ(without.scene_collisions, 0U);
}

TEST_F(FitAmongScenes, ASceneOutOfReachChangesNothing) {
  report(RecordedScene{{kFarAway}, {}, {}});
  const Source among = fit().sources.at(0), without = fit(false).sources.at(0);
  EXPECT_EQ(among.paths_with_scene, kPaths);
  EXPECT_EQ(among.scene_collisions, 0U);
  EXPECT_EQ(among.configurations, without.configurations);
}

TEST_F(FitAmongScenes, PathsWithoutASceneAreNotCounted) {
  report(std::nullopt);
  const Source source = fit().sources.at(0);
  EXPECT_EQ(source.paths_used, kPaths);
  EXPECT_EQ(source.paths_with_scene, 0U);
}

TEST_F(FitAmongScenes, ASceneThatLeavesNothingIsToldWithItsNumbers) {
  report(RecordedScene{{kEverywhere}, {}, {}});
  const Distribution distribution = fit();
  EXPECT_EQ(distribution.state, DistributionState::Failed);
  EXPECT_GT(distribution.sources.at(0).scene_collisions, 0U);
  EXPECT_NE(distribution.reason.find("4 of 4 paths with a recorded scene"), std::string::npos)
      << distribution.reason;
}

TEST_F(FitAmongScenes, WhatAMovingLinkAlwaysTouchesIsToldAndNotLookedAt) {
  report(RecordedScene{{{"flood", BoxShape{{9, 9, 9}}}}, {}, {}});
  const Distribution distribution = fit();
  EXPECT_GT(distribution.configurations, 0U);
  EXPECT_NE(distribution.reason.find("touches 'flood' of a recorded scene wherever it goes"),
            std::string::npos)
      << distribution.reason;
}

TEST_F(FitAmongScenes, ADistributionSaysWhatItWasFilteredWith) {
  const auto tells = [&](const std::string& words, bool avoid = true) {
    const std::string filters = fit(avoid).filters;
    EXPECT_NE(filters.find(words), std::string::npos) << filters;
  };
  report(std::nullopt);
  tells("recorded scenes: not filtered, as no path that was transferred came with one");
  tells("self-collision: 10 links by exact shapes; left out ");
  tells("recorded scenes: not filtered, as the profile says", false);
  first_seed_ = kPaths;
  report(RecordedScene{{kCeiling}, {}, {}});
  tells("recorded scenes: those of 4 of 8 paths; left out ");
  first_seed_ = 2 * kPaths;
  SceneObject rock = kCeiling;
  rock.approximate = true;
  report(RecordedScene{{rock}, {}, {}});
  tells("recorded scenes: those of 8 of 12 paths, 4 of them with solids around meshes");
}

TEST_F(FitAmongScenes, ThreadsMakeNoDifference) {
  report(RecordedScene{{kCeiling}, {}, {}});
  first_seed_ = kPaths;
  report(RecordedScene{{kFarAway, {"flood", BoxShape{{9, 9, 9}}}}, {}, {}});
  const Distribution one = fit(), three = fit(true, 3);
  ASSERT_TRUE(one.mixture && three.mixture);
  EXPECT_EQ(one.mixture->means(), three.mixture->means());
  EXPECT_EQ(one.mixture->covariances(), three.mixture->covariances());
  EXPECT_EQ(one.reason, three.reason);
  EXPECT_NE(one.reason.find("touches 'flood'"), std::string::npos) << one.reason;
  EXPECT_EQ(one.sources.at(0).paths_with_scene, 2 * kPaths);
  EXPECT_EQ(one.sources.at(0).scene_collisions, three.sources.at(0).scene_collisions);
  EXPECT_EQ(one.sources.at(0).filter_checks, three.sources.at(0).filter_checks);
}

}  // namespace
}  // namespace kinship::fitting::scene_filters_test
