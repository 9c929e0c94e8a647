#include "server/fitting/selected_experience.hpp"

#include <gtest/gtest.h>

namespace kinship::fitting::selected_experience_test {
namespace {

using Counts = std::vector<std::uint64_t>;

Digest robot(std::uint8_t number) {
  Digest digest;
  digest.bytes[0] = number;
  return digest;
}

std::vector<Digest> robots_of(const std::vector<store::ExperienceSummary>& experience) {
  std::vector<Digest> robots;
  for (const store::ExperienceSummary& source : experience)
    robots.push_back(source.robot);
  return robots;
}

TEST(SelectedExperience, IsThatOfTheNamedRobots) {
  const std::vector<store::ExperienceSummary> all = {{robot(1), 3, 1}, {robot(2), 4, 1}};
  DistributionKey key;
  key.robot = robot(9);
  EXPECT_EQ(robots_of(selected_experience(key, all)), (std::vector<Digest>{robot(1), robot(2)}));
  key.sources = {robot(2), robot(3)};
  EXPECT_EQ(robots_of(selected_experience(key, all)), std::vector<Digest>{robot(2)});
  EXPECT_EQ(count_paths(selected_experience(key, all)), 4U);
  EXPECT_TRUE(selects(key, robot(3)));
  EXPECT_FALSE(selects(key, robot(1)));
}

TEST(SelectedExperience, RobotsWithoutPathsAreNoSourcesButTheTarget) {
  DistributionKey key;
  key.robot = robot(2);
  EXPECT_EQ(robots_of(selected_experience(key, {{robot(1), 0, 4, 4}, {robot(2), 0, 6, 6}})),
            std::vector<Digest>{robot(2)});
}

TEST(SharePaths, EverythingIsReadWhileItFits) {
  EXPECT_EQ(share_paths({7, 0, 3}, 10, Weighting::Sources), (Counts{7, 0, 3}));
  EXPECT_EQ(share_paths({}, 10, Weighting::Sources), Counts{});
}

TEST(SharePaths, BySourcesSmallOnesAreReadWholeAndTheOthersEvenly) {
  EXPECT_EQ(share_paths({90, 10, 0, 500}, 50, Weighting::Sources), (Counts{20, 10, 0, 20}));
  EXPECT_EQ(share_paths({90, 90}, 50, Weighting::Sources), (Counts{25, 25}));
}

TEST(SharePaths, ByPathsAllAreReadInProportion) {
  EXPECT_EQ(share_paths({90, 10}, 50, Weighting::Paths), (Counts{45, 5}));
}

TEST(SharePaths, EverySourceIsHeard) {
  EXPECT_EQ(share_paths({1000, 1, 1, 0}, 2, Weighting::Paths), (Counts{1, 1, 1, 0}));
  EXPECT_EQ(share_paths({9, 9, 9}, 2, Weighting::Sources), (Counts{1, 1, 1}));
}

}  // namespace
}  // namespace kinship::fitting::selected_experience_test
