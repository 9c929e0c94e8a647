#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"
#include "server/transfer/extension_pool.hpp"
#include "server/transfer/shape_tracker.hpp"
#include "server/transfer/transfer.hpp"
#include "tests/support/joint_distance.hpp"
#include "tests/support/one_by_one.hpp"
#include "tests/support/planar_arm.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::transfer::tracking_test {
namespace {

using kinematics::JointType;
using kinematics::resample;
using test::planar_pose;
using test::PlanarArm;
using test::transfer_path;

constexpr std::uint64_t kSeed = 5;

const PlanarArm kSource{.lengths_m = {0.25, 0.25, 0.2, 0.15, 0.15}, .limit = 2.8};
const PlanarArm kTarget{.lengths_m = {0.18, 0.17, 0.16, 0.15, 0.13, 0.11, 0.1}, .limit = 2.8};

Path source_path() {
  Eigen::MatrixXd waypoints(5, 3);
  waypoints << 0.3, 1.2, 1.5, 0.5, -0.8, -1, 0.4, 0.6, 1.2, -0.6, 0.3, 0.5, 0.2, 0.9, 0.1;
  return Path(waypoints);
}

/// Near the source's base, where a redundant arm can take very different postures.
Path bent_path() {
  Eigen::MatrixXd waypoints(5, 2);
  waypoints << -0.5, 0.6, 1.4, 1.2, 1.2, 1.4, -0.8, -1.0, 0.4, 0.6;
  return Path(waypoints);
}

/// The tracks of one path alone.
const std::vector<Track>& found_tracks(const ArmPair& pair, ShapeTracker& tracker) {
  ShapeTracker* next = &tracker;
  ExtensionPool(pair).run(
      {.next = [&] { return std::exchange(next, nullptr); }, .done = [](ShapeTracker&) {}});
  return tracker.tracks();
}

/// What transfer_paths does before it looks for tracks, and the tracks themselves.
struct Tracking {
  kinematics::Chain source, target;
  ArmPair pair{source, target};
  Eigen::MatrixXd waypoints;
  PathPoses poses;
  CountedFilters counted;
  ShapeTracker tracker;
  std::vector<Track> tracks;

  Tracking(const PlanarArm& from, const PlanarArm& to, const TransferParameters& parameters = {},
           const Filters& filters = {}, const Path& path = source_path())
      : source(from.chain()),
        target(to.chain()),
        waypoints(resample(path, parameters)),
        poses(path_poses(waypoints, pair, Eigen::Isometry3d::Identity())),
        counted(filters),
        tracker(pair, poses, parameters, kSeed, counted),
        tracks(found_tracks(pair, tracker)) {}

  Eigen::Isometry3d T_wanted(Eigen::Index pose) const {
    return poses.T_base_transfer[static_cast<std::size_t>(pose)];
  }
};

/// The laws of every track: poses reached within the limits, without a jump, and enough of them.
void expect_lawful(const Tracking& run, double least_coverage) {
  for (const Track& track : run.tracks) {
    const Eigen::Index count = track.configurations.cols();
    EXPECT_GE(static_cast<double>(count), least_coverage * static_cast<double>(run.poses.size()));
    ASSERT_LE(track.first_pose + count, run.poses.size());
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::VectorXd q = track.configurations.col(i);
      EXPECT_TRUE(run.target.within_limits(q));
      EXPECT_TRUE(inverse::reaches(run.target, run.T_wanted(track.first_pose + i), q));
      if (i == 0)
        continue;
      const double most =
          ShapeTracker::kMaxMotion * run.poses.source_motion[track.first_pose + i - 1] +
          ShapeTracker::kSpareMotion;
      EXPECT_LE(test::distance(run.target, q, track.configurations.col(i - 1)), most + 1e-9);
    }
  }
}

TEST(ShapeTracker, FollowsAPathWithARedundantArm) {
  const Tracking run(kSource, kTarget);
  ASSERT_EQ(run.tracks.size(), 3U);
  expect_lawful(run, 0.9);
}

TEST(ShapeTracker, FollowsAcrossPiOfContinuousJoints) {
  PlanarArm turning = kTarget;
  turning.type = JointType::Continuous;
  Eigen::MatrixXd turned(5, 2);  // the first joint of the source goes once around
  turned << -2.8, 2.8, 0.4, 0.4, 0.3, 0.3, 0.3, 0.3, 0.2, 0.2;
  const auto source = kSource.chain();
  const auto target = turning.chain();
  const ArmPair pair(source, target);
  const PathPoses poses =
      path_poses(resample(Path(turned), {}), pair, planar_pose(0, 0, 1));  // over +-pi on the way
  const Filters none;
  CountedFilters counted(none);
  const TransferParameters parameters;
  ShapeTracker tracker(pair, poses, parameters, kSeed, counted);
  const std::vector<Track> tracks = found_tracks(pair, tracker);
  ASSERT_FALSE(tracks.empty());
  for (const Track& track : tracks)
    for (Eigen::Index i = 0; i < track.configurations.cols(); ++i) {
      EXPECT_LE(track.configurations.col(i).cwiseAbs().maxCoeff(), M_PI);
      if (i > 0) {
        EXPECT_LE(
            test::distance(target, track.configurations.col(i), track.configurations.col(i - 1)),
            ShapeTracker::kMaxMotion * 0.3 + ShapeTracker::kSpareMotion + 1e-9);
      }
    }
}

TEST(ShapeTracker, FollowsWithinNarrowLimits) {
  PlanarArm narrow = kTarget;
  narrow.limit = 1.0;
  const Tracking run(kSource, narrow);
  EXPECT_FALSE(run.tracks.empty());
  expect_lawful(run, 0.9);
}

TEST(ShapeTracker, TakesAPostureLikeTheSources) {
  const auto mean_distance = [](const TransferParameters& parameters) {
    const Tracking run(kSource, kTarget, parameters, {}, bent_path());
    double sum = 0;
    int count = 0;
    for (const Track& track : run.tracks)
      for (Eigen::Index i = 0; i < track.configurations.cols(); ++i, ++count)
        sum +=
            shape_distance(arm_shape(run.target, track.configurations.col(i)),
                           run.poses.source_shapes[static_cast<std::size_t>(track.first_pose + i)]);
    return sum / count;
  };
  // With noise of 10 m the choice is as good as random.
  const double chosen = mean_distance({.tracks = 10, .shape_steps = 0});
  EXPECT_LT(chosen, 0.7 * mean_distance({.tracks = 10, .shape_noise = 10, .shape_steps = 0}));
  EXPECT_LT(mean_distance({.tracks = 10}), 0.5 * chosen);  // and pulled
}

/// Filters are asked about several poses of an extension at once, whichever way it goes.
TEST(ShapeTracker, NoTrackHoldsWhatAFilterRejects) {
  const Tracking all(kSource, kTarget, {.least_coverage = 0});
  ASSERT_FALSE(all.tracks.empty());
  const Eigen::MatrixXd& found = all.tracks.front().configurations;
  std::size_t cut = 0;
  for (Eigen::Index joint = 0; joint < found.rows(); ++joint)
    for (Eigen::Index pose = 0; pose < found.cols(); ++pose)
      for (const double sign : {1.0, -1.0}) {
        const double most = sign * found(joint, pose);
        const auto keeps = [=](const auto& q) { return sign * q[joint] < most; };
        const Filters filters{.self = {}, .scene = test::one_by_one(keeps)};
        const Tracking some(kSource, kTarget, {.least_coverage = 0}, filters);
        for (const Track& track : some.tracks) {
          cut += track.configurations.cols() < some.poses.size() ? 1U : 0U;
          for (const auto& q : track.configurations.colwise())
            ASSERT_TRUE(keeps(q));
        }
      }
  EXPECT_GT(cut, 50U);
}

TEST(TransferWithTracks, ConfigurationsOfAPoseStandInTheOrderOfTheTracks) {
  const Tracking run(kSource, kTarget);
  const auto moved =
      transfer_path(source_path(), run.pair, Eigen::Isometry3d::Identity(), {}, kSeed);
  EXPECT_EQ(moved.summary.tracks_kept, 3U);
  EXPECT_EQ(moved.summary.tracks_tried, run.tracker.tried());
  std::uint64_t through = 0;
  for (const Track& track : run.tracks)
    through += track.configurations.cols() == run.poses.size() ? 1U : 0U;
  EXPECT_GT(through, 0U);
  EXPECT_EQ(moved.summary.tracks_through, through);
  const Track& first = run.tracks.front();
  for (Eigen::Index i = 0; i < moved.configurations.cols(); ++i)
    if (moved.solution_index[i] == 0 && moved.pose_index[i] == first.first_pose) {
      EXPECT_EQ(moved.configurations.col(i), first.configurations.col(0));
    }
}

TEST(TransferWithTracks, WithoutTracksEveryConfigurationIsRandom) {
  const auto moved = transfer_path(source_path(), {kSource.chain(), kTarget.chain()},
                                   Eigen::Isometry3d::Identity(), {.tracks = 0}, kSeed);
  EXPECT_EQ(moved.summary.tracks_tried, 0U);
  EXPECT_EQ(moved.summary.random_configurations, moved.summary.configurations);
  EXPECT_GT(moved.summary.configurations, 0U);
}

TEST(TransferWithTracks, RandomSolutionsFillWhereTracksAreMissing) {
  // An arm that cannot fold: the path leaves its reach in between, no track covers it.
  const PlanarArm stiff{.lengths_m = {0.4, 0.3, 0.2, 0.1}, .limit = 1.0};
  const auto source = kSource.chain();
  const auto target = stiff.chain();
  const auto moved =
      transfer_path(source_path(), {source, target}, planar_pose(0.1, 0, 0), {}, kSeed);
  EXPECT_LT(moved.summary.poses_solved, moved.summary.poses);
  EXPECT_EQ(moved.summary.tracks_kept, 0U);
  EXPECT_EQ(moved.summary.tracks_through, 0U);
  EXPECT_GT(moved.summary.tracks_tried, 0U);
  EXPECT_GT(moved.summary.random_configurations, 0U);
}

TEST(TransferWithFilters, NothingThatAFilterRejectsComesOut) {
  const Filters filters{.self = test::one_by_one([](const auto& q) { return q[1] < 0.5; }),
                        .scene = test::one_by_one([](const auto& q) { return q[2] > -0.5; })};
  for (const int tracks : {0, 3}) {
    const auto moved =
        transfer_path(source_path(), {kSource.chain(), kTarget.chain()},
                      Eigen::Isometry3d::Identity(), {.tracks = tracks}, kSeed, filters);
    const TransferCounts& summary = moved.summary;
    EXPECT_GT(summary.configurations, 0U);
    EXPECT_LT(moved.configurations.row(1).maxCoeff(), 0.5);
    EXPECT_GT(moved.configurations.row(2).minCoeff(), -0.5);
    EXPECT_GT(summary.self_collisions, 0U);
    EXPECT_GT(summary.scene_collisions, 0U);
    EXPECT_GE(summary.filter_checks,
              summary.configurations + summary.self_collisions + summary.scene_collisions);
  }
}

TEST(TransferWithFilters, APathWithoutAFreeConfigurationIsCountedAsColliding) {
  const Filters nothing{.self = test::one_by_one([](const auto&) { return false; }), .scene = {}};
  const auto moved = transfer_path(source_path(), {kSource.chain(), kTarget.chain()},
                                   Eigen::Isometry3d::Identity(), {}, kSeed, nothing);
  EXPECT_EQ(moved.configurations.cols(), 0);
  EXPECT_EQ(moved.summary.colliding, moved.summary.poses);
}

TEST(TransferWithFilters, WaypointsThatAreTakenOverAreNotAskedAbout) {
  const auto arm = kSource.chain();
  const Filters nothing{.self = test::one_by_one([](const auto&) { return false; }), .scene = {}};
  const auto moved =
      transfer_path(source_path(), {arm, arm}, Eigen::Isometry3d::Identity(), {}, kSeed, nothing);
  EXPECT_EQ(moved.summary.poses_solved, moved.summary.poses);
  EXPECT_EQ(moved.summary.filter_checks, 0U);
}

TEST(TransferWithTracks, ParametersOutsideTheirRangeAreRefused) {
  const auto arm = kTarget.chain();
  const auto run = [&](const TransferParameters& parameters) {
    return transfer_path(source_path(), {kSource.chain(), arm}, Eigen::Isometry3d::Identity(),
                         parameters, kSeed);
  };
  EXPECT_THROW(run({.tracks = -1}), std::invalid_argument);
  EXPECT_THROW(run({.least_coverage = 1.1}), std::invalid_argument);
  EXPECT_THROW(run({.track_candidates = 0}), std::invalid_argument);
  EXPECT_THROW(run({.shape_noise = -0.1}), std::invalid_argument);
  EXPECT_THROW(run({.shape_steps = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::transfer::tracking_test
