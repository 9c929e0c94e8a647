#include "server/fitting/fit_distribution.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

#include "proto/mixture/sampler.hpp"
#include "proto/types/pose.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/twins.hpp"
#include "tests/unit/server/fitting/fit_fixture.hpp"
#include "tests/unit/server/fleet.hpp"

namespace kinship::fitting::fit_distribution_test {
namespace {

constexpr std::uint64_t kSeed = 21;

/// Median over samples of the distance of the hand from the nearest hand of the source's paths.
double median_distance_m(const Distribution& distribution, const kinematics::Chain& chain,
                         const std::vector<Path>& paths, const kinematics::Chain& source) {
  std::vector<Eigen::Vector3d> hands;
  for (const Path& path : paths)
    for (Eigen::Index i = 0; i + 1 < path.size(); ++i)
      for (int step = 0; step < 20; ++step) {
        const double s = step / 20.0;
        const Eigen::VectorXd q =
            (1 - s) * path.waypoints().col(i) + s * path.waypoints().col(i + 1);
        hands.push_back(kinematics::T_base_transfer(source, q).translation());
      }
  const mixture::Sampler sampler(*distribution.mixture, distribution.limits);
  std::mt19937_64 generator(kSeed);
  std::vector<double> distances_m;
  for (int i = 0; i < 501; ++i) {
    const Eigen::VectorXd q = sampler.sample(generator).value();
    const Eigen::Vector3d hand = kinematics::T_base_transfer(chain, q).translation();
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& other : hands)
      nearest_m = std::min(nearest_m, (other - hand).norm());
    distances_m.push_back(nearest_m);
  }
  std::nth_element(distances_m.begin(), distances_m.begin() + 250, distances_m.end());
  return distances_m[250];
}

TEST_F(FitDistribution, WithoutPathsThereIsNothingToFit) {
  EXPECT_EQ(fit(key_of(pupil_)).kind, FitOutcome::Kind::NoExperience);
  report({fleet::unsolved(teacher_.digest, "shelf")});
  report(fleet::solved(teacher_, "bin", 3, 1));
  EXPECT_EQ(fit(key_of(pupil_)).kind, FitOutcome::Kind::NoExperience);
}

TEST_F(FitDistribution, AnotherRobotsPathsGuideTheHandAlongThem) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  const Distribution distribution = fitted(key_of(pupil_));
  ASSERT_EQ(distribution.state, DistributionState::Ready) << distribution.reason;
  EXPECT_EQ(distribution.mixture->dimension(), 4);
  EXPECT_EQ(distribution.limits.cols(), 4);

  std::vector<Path> paths;
  for (const store::StoredPath& stored :
       store_->read_paths(teacher_.digest, "shelf", {.after_id = 0, .limit = 100}))
    paths.push_back(stored.path);
  EXPECT_LT(median_distance_m(distribution, pupil_.chain, paths, teacher_.chain), 0.05);
}

TEST_F(FitDistribution, APandasSweepsGuideAUr10eThatHasNeverMoved) {
  const Digest panda = registry_.register_robot(test::model_description("panda"), 1).robot;
  const Digest ur10e = registry_.register_robot(test::model_description("ur10e"), 1).robot;
  std::vector<Attempt> attempts;
  std::vector<Path> paths;
  for (std::uint64_t i = 0; i < 4; ++i) {
    attempts.push_back(test::panda_attempt(panda, "shelf", i));
    paths.push_back(*attempts.back().path);
  }
  report(attempts);
  DistributionKey key = key_of(pupil_);
  key.robot = ur10e;
  const Distribution distribution = fitted(key);
  ASSERT_EQ(distribution.state, DistributionState::Ready) << distribution.reason;
  EXPECT_EQ(distribution.mixture->dimension(), 6);
  EXPECT_GE(distribution.sources[0].poses_solved * 10, distribution.sources[0].poses * 9);
  EXPECT_LT(median_distance_m(distribution, test::model_chain("ur10e"), paths,
                              test::model_chain("panda")),
            0.15);
}

TEST_F(FitDistribution, NamesItsSourcesAndTheirGenerations) {
  report(fleet::solved(teacher_, "shelf", 4, 1));
  report(fleet::solved(pupil_, "shelf", 3, 50));
  report(fleet::solved(pupil_, "shelf", 2, 60));
  const Distribution distribution = fitted(key_of(pupil_));
  EXPECT_EQ(distribution.id, identify(key_of(pupil_)));
  EXPECT_EQ(distribution.store_epoch, store_->epoch());
  EXPECT_EQ(distribution.engines, engines());
  ASSERT_EQ(distribution.sources.size(), 2U);
  for (const Source& source : distribution.sources) {
    const bool own = source.robot == pupil_.digest;
    EXPECT_EQ(source.label, own ? "pupil" : "teacher");
    EXPECT_EQ(source.paths, own ? 5U : 4U);
    EXPECT_EQ(source.generation, store_->generation(source.robot, "shelf"));
    EXPECT_GT(source.poses, 0U);
    EXPECT_GE(source.poses, source.poses_solved);
  }
  EXPECT_DOUBLE_EQ(distribution.advice.recommended_share, 0.9);
  EXPECT_EQ(distribution.advice.evidence, "share of profile 'default'; no attempts compared yet");
}

TEST_F(FitDistribution, OwnPathsAtTheOwnPlaceAreTakenOverAsTheyAre) {
  DistributionKey key = key_of(teacher_);
  key.T_task_base = snapped(Eigen::Isometry3d(Eigen::Translation3d(0.1234, 0.2, 0)));
  std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 10, 1);
  for (Attempt& attempt : attempts)
    attempt.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.1232, 0.2, 0));
  report(attempts);
  const Distribution distribution = fitted(key);
  EXPECT_EQ(distribution.sources[0].poses_solved, distribution.sources[0].poses);
  // One configuration a pose: inverse kinematics would have found the other elbow too.
  EXPECT_EQ(distribution.configurations, distribution.sources[0].poses);
  EXPECT_EQ(distribution.reason, "");
}

TEST_F(FitDistribution, EqualContentGivesEqualMixtures) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  const Distribution a = fitted(key_of(pupil_));
  const Distribution b = fitted(key_of(pupil_));
  EXPECT_EQ(a.mixture->means(), b.mixture->means());
  EXPECT_EQ(a.mixture->weights(), b.mixture->weights());
}

TEST_F(FitDistribution, WhatNothingReachesFailsWithTheReasonOfEachSource) {
  report(fleet::solved(teacher_, "shelf", 3, 1));
  report(fleet::solved(pupil_, "shelf", 2, 9));
  const Distribution distribution = fitted(key_of(dwarf_));
  EXPECT_EQ(distribution.state, DistributionState::Failed);
  EXPECT_FALSE(distribution.mixture);
  EXPECT_EQ(distribution.configurations, 0U);
  for (const char* part : {"nothing could be transferred to 'dwarf'", "'teacher': 3 paths, ",
                           "'pupil': 2 paths, ", " 0 solved, ", " out of reach, "})
    EXPECT_NE(distribution.reason.find(part), std::string::npos) << distribution.reason;
}

TEST_F(FitDistribution, TooFewConfigurationsFailWithTheReasonOfTheFit) {
  Attempt attempt = fleet::solved(teacher_, "shelf", 1);
  attempt.path = Path(Eigen::MatrixXd::Constant(3, 2, 0.5));
  report({attempt});
  const Distribution distribution = fitted(key_of(teacher_));
  EXPECT_EQ(distribution.state, DistributionState::Failed);
  EXPECT_NE(distribution.reason.find("1 configurations for 'teacher' could not be fitted"),
            std::string::npos)
      << distribution.reason;
}

TEST_F(FitDistribution, WarnsWhenGivenAndMissingPlacementsArePooled) {
  std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 5, 1);
  report(attempts);
  EXPECT_EQ(fitted(key_of(teacher_)).reason, "");
  DistributionKey placed = key_of(teacher_);
  placed.T_task_base = Eigen::Isometry3d::Identity();
  EXPECT_EQ(fitted(placed).reason, "some placements are missing and were taken as the identity");
}

TEST_F(FitDistribution, PlacementsMoveTheHandInTheTask) {
  // The teacher stands 0.15 m behind the task's origin; the pupil in it, then beside the teacher.
  const Eigen::Vector3d offset(-0.15, 0, 0);
  std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 10, 1);
  for (Attempt& attempt : attempts)
    attempt.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(offset));
  report(attempts);
  DistributionKey key = key_of(pupil_);
  key.T_task_base = Eigen::Isometry3d::Identity();
  const Distribution moved = fitted(key);
  key.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(offset));
  const Distribution beside = fitted(key);
  ASSERT_TRUE(moved.mixture) << moved.reason;
  ASSERT_TRUE(beside.mixture) << beside.reason;
  const auto mean_hand = [this](const Mixture& mixture) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < mixture.size(); ++k)
      mean += mixture.weights()[k] *
              kinematics::T_base_transfer(pupil_.chain, mixture.means().col(k)).translation();
    return mean;
  };
  EXPECT_NEAR((mean_hand(*moved.mixture) - mean_hand(*beside.mixture)).x(), offset.x(), 0.05);
}

TEST_F(FitDistribution, RobotsThatCannotBeReadAreLeftOutAndNamed) {
  Digest wrong;
  wrong.bytes[0] = 0xAB;
  RobotDescription other = fleet::planar("stranger", {0.1, 0.1, 0.1});
  ASSERT_TRUE(store_->register_robot(
      {.digest = wrong, .description = other, .dof = 3, .registered_ms = 1}));
  Attempt strange = fleet::solved(teacher_, "shelf", 70);
  strange.robot = wrong;
  report({strange});
  report(fleet::solved(teacher_, "shelf", 5, 1));
  const Distribution distribution = fitted(key_of(teacher_));
  EXPECT_EQ(distribution.state, DistributionState::Ready);
  EXPECT_NE(distribution.reason.find("left out, robot 'stranger'"), std::string::npos)
      << distribution.reason;
}

/// Paths are transferred in groups; one of them has a length that no number holds.
TEST_F(FitDistribution, APathThatCannotBeTransferredCostsNothingButItself) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  const Distribution without = fitted(quick_key_of(pupil_));
  Attempt endless = fleet::solved(teacher_, "shelf", 70);
  Eigen::MatrixXd waypoints = endless.path->waypoints();
  waypoints(0, 0) = 1e308;
  waypoints(0, 1) = -1e308;
  endless.path = Path(waypoints);
  report({endless});
  const Distribution with = fitted(quick_key_of(pupil_));
  EXPECT_EQ(source(with, teacher_).paths, 21U);
  EXPECT_EQ(source(with, teacher_).paths_used, 20U);
  EXPECT_NE(with.reason.find("the length of the path is not finite"), std::string::npos)
      << with.reason;
  EXPECT_EQ(with.configurations, without.configurations);
  EXPECT_EQ(with.mixture->means(), without.mixture->means());
}

TEST_F(FitDistribution, OfMorePathsThanItMayReadEachSourceGivesAsMany) {
  report(fleet::solved(teacher_, "shelf", 90, 1));
  report(fleet::solved(pupil_, "shelf", 10, 200));
  context_.max_paths = 50;
  const Distribution distribution = fitted(quick_key_of(pupil_));
  EXPECT_EQ(distribution.reason, "'teacher': 40 of 90 paths read");
  EXPECT_EQ(source(distribution, teacher_).paths, 90U);
  EXPECT_EQ(source(distribution, teacher_).paths_used, 40U);
  EXPECT_EQ(source(distribution, pupil_).paths_used, 10U);

  DistributionKey by_paths = quick_key_of(pupil_);
  by_paths.profile.density.weighting = Weighting::Paths;
  const Distribution proportional = fitted(by_paths);
  EXPECT_EQ(source(proportional, teacher_).paths_used, 45U);
  EXPECT_EQ(source(proportional, pupil_).paths_used, 5U);
}

TEST_F(FitDistribution, SourcesWeighTheSameAndOwnExperienceHalf) {
  report(fleet::solved(teacher_, "shelf", 40, 1));
  report(fleet::solved(pupil_, "shelf", 5, 200));
  const Distribution few = fitted(quick_key_of(pupil_));
  EXPECT_NEAR(source(few, teacher_).mass, 0.5, 1e-9);
  EXPECT_NEAR(source(few, pupil_).mass, 0.5, 1e-9);

  const runtime::Robot third = fleet::robot_of(fleet::planar("third", {0.4, 0.32, 0.2}));
  registry_.register_robot(fleet::planar("third", {0.4, 0.32, 0.2}), 1);
  report(fleet::solved(third, "shelf", 1, 300));
  report(fleet::solved(pupil_, "shelf", 30, 400));
  const Distribution distribution = fitted(quick_key_of(pupil_));
  EXPECT_NEAR(source(distribution, pupil_).mass, 0.5, 1e-9);
  EXPECT_NEAR(source(distribution, teacher_).mass, 0.5 * 5 / 6, 1e-9);
  EXPECT_NEAR(source(distribution, third).mass, 0.5 * 1 / 6, 1e-9);
}

TEST_F(FitDistribution, ByPathsASourceWeighsWhatItHas) {
  report(fleet::solved(teacher_, "shelf", 30, 1));
  report(fleet::solved(pupil_, "shelf", 10, 200));
  DistributionKey key = quick_key_of(pupil_);
  key.profile.density.weighting = Weighting::Paths;
  const Distribution distribution = fitted(key);
  EXPECT_NEAR(source(distribution, teacher_).mass, 0.75, 1e-9);
  EXPECT_EQ(distribution.selection.weighting, Weighting::Paths);
}

TEST_F(FitDistribution, OnlySelectedSourcesAreUsed) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  report(fleet::solved(pupil_, "shelf", 6, 200));
  DistributionKey key = key_of(pupil_);
  key.sources = {teacher_.digest};
  const Distribution distribution = fitted(key);
  ASSERT_EQ(distribution.sources.size(), 1U);
  EXPECT_EQ(distribution.sources[0].robot, teacher_.digest);
  EXPECT_EQ(distribution.selection.sources, key.sources);
  key.sources = {dwarf_.digest};
  EXPECT_EQ(fit(key).kind, FitOutcome::Kind::NoExperience);
}

TEST_F(FitDistribution, EverySourceSaysWhatBecameOfItsPoses) {
  report(fleet::solved(teacher_, "shelf", 6, 1));
  report(fleet::solved(pupil_, "shelf", 6, 200));
  for (const Source& source : fitted(key_of(pupil_)).sources) {
    EXPECT_EQ(source.paths_used, 6U);
    EXPECT_EQ(source.poses, source.poses_solved + source.out_of_reach + source.outside_limits +
                                source.not_converged);
    const bool own = source.robot == pupil_.digest;
    EXPECT_EQ(source.relation, own ? Relation::Identical : Relation::Other);
    if (own)
      EXPECT_EQ(source.configurations, source.poses);
    else
      EXPECT_GT(source.configurations, source.poses_solved);
  }
}

TEST_F(FitDistribution, ACalibratedUr10eTakesItsTwinsWaypointsOverInEveryProfile) {
  const RobotDescription model = test::model_description("ur10e");
  const RobotDescription twins[] = {test::calibrated_twin(model, "twin_a", 2e-4, kSeed),
                                    test::calibrated_twin(model, "twin_b", 2e-4, kSeed + 1)};
  const Digest a = registry_.register_robot(twins[0], 1).robot;
  const Digest b = registry_.register_robot(twins[1], 1).robot;
  ASSERT_NE(a, b);
  std::vector<Attempt> attempts;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    attempts.push_back(fleet::solved(pupil_, "shelf", seed));
    attempts.back().robot = a;
    attempts.back().path = fleet::path(6, seed);
  }
  report(attempts);
  for (const char* profile : {"default", "paper"}) {
    DistributionKey key = key_of(pupil_);
    key.robot = b;
    key.profile = *find_profile(profile);
    key.profile.density.components = 3;
    key.profile.transfer.pose_spacing = 0.5;
    const Distribution distribution = fitted(key);
    ASSERT_EQ(distribution.state, DistributionState::Ready) << distribution.reason;
    const Source& source = distribution.sources.at(0);
    EXPECT_EQ(source.relation, Relation::SameArm);
    EXPECT_EQ(source.configurations, source.poses_solved) << "one each: not by random solutions";
    EXPECT_GT(source.poses_solved * 10, source.poses * 9);
    // At another place the same arm is any other.
    key.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.05, 0, 0));
    const Source elsewhere = fitted(key).sources.at(0);
    EXPECT_EQ(elsewhere.relation, Relation::SameArm);
    EXPECT_GT(elsewhere.configurations, elsewhere.poses_solved);
  }
}

TEST_F(FitDistribution, IsThinExactlyBelowAFifthOfThePosesAndStartsWithHalfTheSamples) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  int thin = 0, ready = 0;
  for (const double away_m : {0.0, 0.7, 1.5, 1.52, 1.54, 1.55, 1.56, 1.57, 1.58}) {
    DistributionKey key = key_of(pupil_);
    key.profile.density.components = 2;
    key.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(away_m, 0, 0));
    const Distribution distribution = fitted(key);
    if (!has_mixture(distribution.state))
      continue;
    const Source& source = distribution.sources.at(0);
    const double solved =
        static_cast<double>(source.poses_solved) / static_cast<double>(source.poses);
    const bool is_thin = distribution.state == DistributionState::Thin;
    EXPECT_EQ(is_thin, solved < kThinShare) << away_m << " m away, " << solved;
    EXPECT_DOUBLE_EQ(distribution.advice.recommended_share, is_thin ? 0.5 : 0.9);
    ++(is_thin ? thin : ready);
  }
  EXPECT_GT(thin, 0);
  EXPECT_GT(ready, 0);
}

TEST_F(FitDistribution, TheTargetsOwnGeometryFiltersItsConfigurations) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  RobotDescription thick = fleet::planar("thick", {0.3, 0.3, 0.2, 0.15});
  for (const std::string link : {"link1", "link2", "link3", "link4"}) {
    const std::string bare = "<link name='" + link + "'/>";
    thick.urdf.replace(thick.urdf.find(bare), bare.size(),
                       "<link name='" + link +
                           "'><collision><origin xyz='0.1 0 0'/><geometry>"
                           "<box size='0.2 0.4 0.1'/></geometry></collision></link>");
  }
  DistributionKey key = key_of(pupil_);
  key.robot = registry_.register_robot(thick, 1).robot;
  key.profile.density.components = 2;
  key.profile.transfer.tracks = 0;
  const Source filtered = fitted(key).sources.at(0);
  EXPECT_GT(filtered.self_collisions, 0U);
  EXPECT_GT(filtered.filter_checks, filtered.self_collisions);
  EXPECT_EQ(filtered.scene_collisions, 0U);

  key.profile.transfer.avoid_self_collision = false;
  const Source all = fitted(key).sources.at(0);
  EXPECT_EQ(all.filter_checks, 0U);
  EXPECT_GT(all.configurations, filtered.configurations);
}

TEST_F(FitDistribution, SaysHowTracksFared) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  DistributionKey key = key_of(pupil_);
  key.profile.density.components = 2;
  const Source tracked = fitted(key).sources.at(0);
  EXPECT_GT(tracked.tracks_kept, 0U);
  EXPECT_LE(tracked.tracks_kept, tracked.tracks_tried);
  EXPECT_GT(tracked.tracks_through, 0U);
  EXPECT_LE(tracked.tracks_through, tracked.tracks_tried);
  EXPECT_GT(tracked.poses_on_tracks, 0U);
  EXPECT_LE(tracked.poses_on_tracks, tracked.poses_solved);
  EXPECT_LT(tracked.random_configurations, tracked.configurations);
  key.profile = *find_profile("paper");
  key.profile.density.components = 2;
  const Source paper = fitted(key).sources.at(0);
  EXPECT_EQ(paper.tracks_tried, 0U);
  EXPECT_EQ(paper.poses_on_tracks, 0U);
  EXPECT_EQ(paper.filter_checks, 0U);
  EXPECT_EQ(paper.random_configurations, paper.configurations);
}

TEST_F(FitDistribution, GivesUpWhenAskedTo) {
  report(fleet::solved(teacher_, "shelf", 5, 1));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(fit_distribution(key_of(pupil_), context_, stop.get_token()).kind,
            FitOutcome::Kind::Abandoned);
}

TEST_F(FitDistribution, AnUnknownTargetEndsTheRequest) {
  DistributionKey key = key_of(pupil_);
  key.robot.bytes[0] ^= 1U;
  EXPECT_THROW(fit(key), Failure);
}

}  // namespace
}  // namespace kinship::fitting::fit_distribution_test
