#include "server/fitting/experience_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <random>

namespace kinship::fitting::experience_choice_test {
namespace {

Eigen::Isometry3d pose_at(double x, double y, double turn_rad = 0) {
  return Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
}

SharedPosePath path_between(const Eigen::Isometry3d& start, const Eigen::Isometry3d& goal,
                            std::uint8_t number) {
  PosePath path{{}, {}, {start, goal}};
  path.path.bytes[0] = number;
  return std::make_shared<const PosePath>(path);
}

std::vector<SharedPosePath> random_paths(int count, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> within(-1, 1);
  std::vector<SharedPosePath> paths;
  for (int i = 0; i < count; ++i) {
    const auto pose = [&] {
      const double x = within(generator), y = within(generator);
      return pose_at(x, y, 3 * within(generator));
    };
    const Eigen::Isometry3d start = pose();
    paths.push_back(path_between(start, pose(), static_cast<std::uint8_t>(i)));
  }
  return paths;
}

/// Largest distance of a path from the nearest chosen one.
double farthest_from(const std::vector<SharedPosePath>& chosen,
                     const std::vector<SharedPosePath>& paths) {
  double farthest = 0;
  for (const SharedPosePath& path : paths) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const SharedPosePath& one : chosen)
      nearest = std::min(nearest, distance_of_ends(*path, *one));
    farthest = std::max(farthest, nearest);
  }
  return farthest;
}

constexpr std::size_t kTwoPoses = experience_bytes(2);

TEST(ExperienceChoice, DistanceIsOfBothEndsInPlaceAndTurn) {
  const SharedPosePath a = path_between(pose_at(0, 0), pose_at(1, 0), 1);
  const SharedPosePath b = path_between(pose_at(0, 2), pose_at(1, 0, 0.5), 2);
  EXPECT_NEAR(distance_of_ends(*a, *b), 2 + 0.3 * 0.5, 1e-9);
  EXPECT_NEAR(
      distance_of_ends(*a, *path_between(pose_at(0, 0, 2 * std::numbers::pi), pose_at(1, 0), 3)), 0,
      1e-7);
}

TEST(ExperienceChoice, BeginsWithTheNewestAndGoesOnWithTheFarthest) {
  const auto at = [](double x, std::uint8_t number) {
    return path_between(pose_at(0, 0), pose_at(x, 0), number);
  };
  const std::vector<SharedPosePath> paths = {at(5, 1), at(-4, 2), at(1, 3), at(5, 4), at(0, 5)};
  const ExperienceChoice choice = choose_experience(paths, 3 * kTwoPoses);
  EXPECT_EQ(choice.paths, (std::vector{paths[4], paths[3], paths[1]}));  // of two at 5 the newer
  EXPECT_EQ(choice.paths_known, 5U);
}

TEST(ExperienceChoice, CoversStartsAndGoalsBetterThanTheNewestDo) {
  std::vector<SharedPosePath> paths = random_paths(150, 3);
  for (int i = 0; i < 100; ++i)  // today it was the same all day
    paths.push_back(path_between(pose_at(1e-3 * i, 0), pose_at(0, 1), 151));
  const ExperienceChoice choice = choose_experience(paths, 50 * kTwoPoses);
  ASSERT_EQ(choice.paths.size(), 50U);
  const std::vector<SharedPosePath> newest(paths.end() - 50, paths.end());
  EXPECT_LT(farthest_from(choice.paths, paths), 0.6 * farthest_from(newest, paths));
  // Whoever was not chosen is nearer to the choice than any two chosen are to each other.
  double nearest_pair = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < choice.paths.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest_pair = std::min(nearest_pair, distance_of_ends(*choice.paths[i], *choice.paths[j]));
  EXPECT_LE(farthest_from(choice.paths, paths), nearest_pair);
}

TEST(ExperienceChoice, KeepsWithinItsBytes) {
  const std::vector<SharedPosePath> paths = random_paths(20, 4);
  EXPECT_EQ(choose_experience(paths, 0).paths.size(), 0U);
  EXPECT_EQ(choose_experience(paths, kTwoPoses - 1).paths.size(), 0U);
  EXPECT_EQ(choose_experience(paths, kTwoPoses).paths.size(), 1U);
  EXPECT_EQ(choose_experience(paths, 7 * kTwoPoses + 1).paths.size(), 7U);
  EXPECT_EQ(choose_experience(paths, 1000 * kTwoPoses).paths.size(), 20U);
  std::vector<SharedPosePath> longer;
  for (const SharedPosePath& path : paths) {
    PosePath with_more = *path;
    with_more.poses.resize(kExperiencePoses, with_more.poses.back());
    longer.push_back(std::make_shared<const PosePath>(with_more));
  }
  EXPECT_EQ(choose_experience(longer, 3 * experience_bytes(kExperiencePoses)).paths.size(), 3U);
}

TEST(ExperienceChoice, OfFewerBytesIsTheBeginningOfIt) {
  const std::vector<SharedPosePath> paths = random_paths(60, 5);
  const ExperienceChoice many = choose_experience(paths, 40 * kTwoPoses);
  const ExperienceChoice few = choose_experience(paths, 9 * kTwoPoses);
  const ExperienceChoice cut = shortened(many, 9 * kTwoPoses);
  EXPECT_EQ(cut.paths, few.paths);
  EXPECT_EQ(cut.revision, few.revision);
  EXPECT_NE(cut.revision, many.revision);
  EXPECT_EQ(shortened(many, 40 * kTwoPoses).revision, many.revision);
}

TEST(ExperienceChoice, RevisionIsThatOfWhatWasChosen) {
  std::vector<SharedPosePath> paths = random_paths(30, 6);
  const std::uint64_t revision = choose_experience(paths, 10 * kTwoPoses).revision;
  EXPECT_EQ(choose_experience(random_paths(30, 6), 10 * kTwoPoses).revision, revision);
  EXPECT_NE(choose_experience({}, 0).revision, 0U);
  paths.push_back(path_between(pose_at(9, 9), pose_at(9, 9), 200));
  EXPECT_NE(choose_experience(paths, 10 * kTwoPoses).revision, revision);
  paths.pop_back();
  paths.erase(paths.begin() + 3);
  EXPECT_NE(choose_experience(paths, 1000 * kTwoPoses).revision,
            choose_experience(random_paths(30, 6), 1000 * kTwoPoses).revision);
}

TEST(ExperienceChoice, BecomesAnExperienceInItsOrder) {
  const std::vector<SharedPosePath> paths = random_paths(30, 7);
  const ExperienceChoice choice = choose_experience(paths, 3 * kTwoPoses);
  const TaskExperience experience = to_experience(choice);
  EXPECT_EQ(experience.revision, choice.revision);
  EXPECT_EQ(experience.paths_known, 30U);
  ASSERT_EQ(experience.paths.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(experience.paths[i].path, choice.paths[i]->path);
}

}  // namespace
}  // namespace kinship::fitting::experience_choice_test
