#include "robots/planning/experience_guide.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <random>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "tests/support/robots.hpp"

namespace kinship::planning::experience_guide_test {
namespace {

/// A robot before and after a motion of its own, and where its base stands.
struct Motion {
  kinematics::Chain chain;
  Eigen::VectorXd start, goal;
  Eigen::Isometry3d T_task_base{Eigen::Translation3d(0.3, -0.2, 0.1)};

  Eigen::Isometry3d hand(const Eigen::VectorXd& q) const {
    return T_task_base * kinematics::T_base_transfer(chain, q);
  }
  /// By straight motion in joint space.
  PosePath path() const {
    PosePath path;
    for (int i = 0; i < kExperiencePoses; ++i)
      path.poses.push_back(hand(start + i / (kExperiencePoses - 1.0) * (goal - start)));
    return path;
  }
  TrackQuery query() const { return {T_task_base, planning_bounds(chain, start), start, goal}; }
};

Motion panda_motion() {
  return {test::model_chain("panda"), Eigen::VectorXd{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}},
          Eigen::VectorXd{{0.9, 0.2, 0.1, -1.7, 0.1, 2.0, 1.2}}};
}

ExperienceGuide guide_of(const kinematics::Chain& chain, std::vector<PosePath> paths) {
  TaskExperience experience;
  experience.revision = 4;
  experience.paths = std::move(paths);
  return ExperienceGuide(chain, std::move(experience));
}

std::vector<Track> tracks_of(const ExperienceGuide& guide, const TrackQuery& query,
                             const TrackOptions& options = {}) {
  return guide.follow(query, guide.choose(query, options), options);
}

TEST(ExperienceGuide, TheHandKeepsToTheMovedPathFromTheGoalToTheStart) {
  const Motion motion = panda_motion();
  const ExperienceGuide guide = guide_of(motion.chain, {motion.path()});
  // Another query: both ends elsewhere.
  TrackQuery query = motion.query();
  query.goals.col(0) += Eigen::VectorXd{{0.1, -0.1, 0.05, 0.1, -0.1, 0.1, 0.2}};
  query.start[1] += 0.15;
  const std::vector<Track> tracks = tracks_of(guide, query);
  ASSERT_EQ(tracks.size(), 1U);
  const Eigen::MatrixXd& track = tracks[0].configurations;
  EXPECT_EQ(track.col(0), query.goals.col(0));
  EXPECT_GT(track.cols(), 35);
  const auto wanted =
      moved_onto(motion.path(), {motion.hand(query.start), motion.hand(query.goals.col(0))});
  for (const auto& q : track.colwise()) {
    double nearest = 1;
    for (const Eigen::Isometry3d& pose : wanted)
      nearest = std::min(nearest, pose_distance_m(motion.hand(q), pose));
    EXPECT_LT(nearest, 0.04 + 0.3 * 0.25);
    EXPECT_TRUE(((q - motion.chain.lower()).array() >= -1e-9).all());
    EXPECT_TRUE(((motion.chain.upper() - q).array() >= -1e-9).all());
  }
  for (Eigen::Index i = 1; i < track.cols(); ++i)
    EXPECT_LT((track.col(i) - track.col(i - 1)).norm(), 0.5);
  EXPECT_LT(tracks[0].gap, 1.0);
}

TEST(ExperienceGuide, AnotherArmFollowsTheHandOfTheFirst) {
  const Motion panda = panda_motion();
  Motion iiwa{test::model_chain("iiwa14"), Eigen::VectorXd{{0.2, 0.4, 0, -1.4, 0, 1.0, 0}},
              Eigen::VectorXd{{0.9, 0.7, 0.1, -1.2, 0.1, 0.9, 0.3}}};
  const ExperienceGuide guide = guide_of(iiwa.chain, {panda.path()});
  const std::vector<Track> tracks = tracks_of(guide, iiwa.query());
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_GT(tracks[0].configurations.cols(), 20);
  EXPECT_EQ(tracks[0].configurations.col(0), iiwa.goal);
}

TEST(ExperienceGuide, TakesEveryGoalBeforeASecondPathAndNotMoreThanItMay) {
  const Motion motion = panda_motion();
  const ExperienceGuide guide = guide_of(motion.chain, std::vector(5, motion.path()));
  TrackQuery query = motion.query();
  query.goals = motion.goal.replicate(1, 3);
  query.goals.col(0) += Eigen::VectorXd::Constant(7, 0.2);  // the farthest
  const auto choices = guide.choose(query, {.paths = 2, .tracks = 5});
  ASSERT_EQ(choices.size(), 5U);
  EXPECT_EQ(choices[0].goal, 1);
  EXPECT_EQ(choices[2].goal, 0);
  EXPECT_EQ(choices[2].path, choices[0].path);
  EXPECT_NE(choices[3].path, choices[0].path);
  EXPECT_EQ(guide.choose(query, {.paths = 2, .tracks = 100}).size(), 6U);
  EXPECT_EQ(guide.choose(query, {.paths = 9, .tracks = 2}).size(), 2U);
}

TEST(ExperienceGuide, TheAnswerToAQueryThatIsPlannedAgainIsNotFollowed) {
  const Motion motion = panda_motion();
  std::vector<PosePath> paths(3, motion.path());
  for (PosePath& path : paths)
    path.path = Uuid::random();
  const ExperienceGuide guide = guide_of(motion.chain, paths);
  TrackQuery query = motion.query();
  query.without = paths[0].path;  // else the first of three that are equally near
  EXPECT_EQ(guide.choose(motion.query(), {.paths = 2}).front().path, 0U);
  const auto choices = guide.choose(query, {.paths = 2});
  ASSERT_EQ(choices.size(), 2U) << "others take its place";
  for (const ExperienceGuide::Choice& choice : choices)
    EXPECT_NE(choice.path, 0U);
}

TEST(ExperienceGuide, WithoutPathsOrGoalsThereIsNothingToFollow) {
  const Motion motion = panda_motion();
  EXPECT_TRUE(tracks_of(guide_of(motion.chain, {}), motion.query()).empty());
  TrackQuery nowhere = motion.query();
  nowhere.goals.resize(7, 0);
  EXPECT_TRUE(tracks_of(guide_of(motion.chain, {motion.path()}), nowhere).empty());
}

TEST(QueryTracks, PathsThatFailedComeLastAndEndBeforeWhatTheyLack) {
  const Motion motion = panda_motion();
  TrackQuery query = motion.query();
  Eigen::MatrixXd path(7, 4);
  for (int i = 0; i < 4; ++i)
    path.col(i) = motion.start + i / 3.0 * (motion.goal - motion.start);
  path(3, 1) = std::numeric_limits<double>::quiet_NaN();
  int asked = 0;
  query.failed_paths = [&] {
    ++asked;
    return std::vector{path};
  };
  TaskExperience experience;
  experience.paths = {motion.path()};
  QueryTracks tracks(std::make_shared<const ExperienceGuide>(motion.chain, experience), query, {});
  ASSERT_NE(tracks.track(0), nullptr);
  EXPECT_FALSE(tracks.track(0)->is_goal_free);
  EXPECT_EQ(asked, 0);
  const Track* const failed = tracks.track(1);
  ASSERT_NE(failed, nullptr);
  EXPECT_TRUE(failed->is_goal_free);
  EXPECT_EQ(failed->configurations, path.rightCols(2).rowwise().reverse());
  EXPECT_EQ(tracks.track(2), nullptr);
  EXPECT_EQ(asked, 1);
}

TEST(ExperienceGuide, TheRetreatComesBeforeStoredWaysAndNeedsNone) {
  const Motion motion = panda_motion();
  const auto with =
      guide_of(motion.chain, {motion.path()}).choose(motion.query(), {.retreats = 40});
  ASSERT_EQ(with.size(), 2U);
  EXPECT_FALSE(with[0].path);
  EXPECT_EQ(with[1].path, 0U);
  const ExperienceGuide none = guide_of(motion.chain, {});
  const std::vector<Track> tracks = tracks_of(none, motion.query(), {.retreats = 1});
  ASSERT_EQ(tracks.size(), 1U);
  // Close to the goal the hand moves along the palm's axis.
  const Eigen::Isometry3d goal = motion.hand(motion.goal);
  const Eigen::Vector3d before =
      goal.inverse() * motion.hand(tracks[0].configurations.col(3)).translation();
  EXPECT_LT(before.z(), -0.02);
  EXPECT_LT(before.head<2>().norm(), 0.02);
}

TEST(ExperienceGuide, RefusesAPathOfOnePose) {
  const Motion motion = panda_motion();
  PosePath point = motion.path();
  point.poses.resize(1);
  EXPECT_THROW(guide_of(motion.chain, {point}), std::invalid_argument);
}

TEST(QueryTracks, SamplesLieAroundTheTracksAndWithinTheBounds) {
  const Motion motion = panda_motion();
  auto guide = std::make_shared<ExperienceGuide>(guide_of(motion.chain, {motion.path()}));
  const TrackQuery query = motion.query();
  TrackOptions options;
  options.retreat_m = {};
  options.deviation = 0.1;
  auto tracks = std::make_shared<QueryTracks>(guide, query, options);
  ASSERT_NE(tracks->track(0), nullptr);
  EXPECT_EQ(tracks->track(1), nullptr);
  const Eigen::MatrixXd along = tracks->track(0)->configurations;
  const ConfigurationSampler sampler = ConfigurationSampler(query.bounds).with_tracks(tracks, 0.75);
  EXPECT_EQ(sampler.guided_fraction(), 0.75);
  std::mt19937_64 generator(3);
  int around = 0;
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::VectorXd q = sampler.sample(generator);
    EXPECT_TRUE((q.array() >= query.bounds.row(0).transpose().array()).all());
    EXPECT_TRUE((q.array() <= query.bounds.row(1).transpose().array()).all());
    around += (along.colwise() - q).colwise().norm().minCoeff() < 0.1 * 5 ? 1 : 0;
  }
  EXPECT_NEAR(around, 0.75 * kDraws, 100);
  around = 0;
  for (int i = 0; i < kDraws; ++i)
    around += (along.colwise() - sampler.sample(generator, 0.25)).colwise().norm().minCoeff() < 0.5;
  EXPECT_NEAR(around, 0.25 * kDraws, 100);
}

TEST(QueryTracks, AMixtureKeepsWhatTheTracksLeave) {
  const Motion motion = panda_motion();
  auto guide = std::make_shared<ExperienceGuide>(guide_of(motion.chain, {}));
  auto tracks = std::make_shared<QueryTracks>(guide, motion.query(), TrackOptions{});
  const Mixture at_start(Eigen::VectorXd::Ones(1), motion.start,
                         {1e-6 * Eigen::MatrixXd::Identity(7, 7)});
  const ConfigurationSampler sampler =
      ConfigurationSampler(motion.query().bounds, motion.chain, at_start, 0.8)
          .with_tracks(tracks, 0.5);
  EXPECT_EQ(sampler.guided_fraction(), 1);
  std::mt19937_64 generator(1);
  int near = 0;
  constexpr int kDraws = 2000;
  for (int i = 0; i < kDraws; ++i)
    near += (sampler.sample(generator) - motion.start).norm() < 0.05 ? 1 : 0;
  EXPECT_NEAR(near, 0.5 * kDraws, 100);  // where there is no track, samples are uniform
  EXPECT_THROW(ConfigurationSampler(motion.query().bounds).with_tracks(tracks, 1.5),
               std::invalid_argument);
}

TEST(QueryTracks, RefusesADeviationThatIsNone) {
  const Motion motion = panda_motion();
  auto guide = std::make_shared<ExperienceGuide>(guide_of(motion.chain, {}));
  TrackOptions options;
  options.deviation = -1;
  EXPECT_THROW(QueryTracks(guide, motion.query(), options), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::planning::experience_guide_test
