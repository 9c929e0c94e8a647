#include "server/fitting/source_masses.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "server/fitting/selected_experience.hpp"

namespace kinship::fitting::source_masses_test {
namespace {

TEST(SourceMasses, NothingWeighsNothing) {
  EXPECT_TRUE(source_masses({}).empty());
  EXPECT_EQ(source_masses({{0, true}, {0, false}}), (std::vector<double>{0, 0}));
}

TEST(SourceMasses, SourcesOfFivePathsOrMoreWeighTheSame) {
  for (const double mass : source_masses({{5, false}, {70, false}, {4000, false}, {9, false}}))
    EXPECT_DOUBLE_EQ(mass, 0.25);
}

TEST(SourceMasses, FewerPathsAreAFifthOfAPartEach) {
  const std::vector<double> masses = source_masses({{1, false}, {2, false}, {50, false}});
  EXPECT_NEAR(masses[0], 1 / 8.0, 1e-12);
  EXPECT_NEAR(masses[1], 2 / 8.0, 1e-12);
  EXPECT_NEAR(masses[2], 5 / 8.0, 1e-12);
}

TEST(SourceMasses, OwnExperienceIsHalfOfAllFromThirtyPathsOn) {
  for (const std::uint64_t paths : {30U, 31U, 1000U}) {
    const std::vector<double> masses =
        source_masses({{40, false}, {paths, true}, {40, false}, {40, false}});
    EXPECT_NEAR(masses[1], 0.5, 1e-12);
    EXPECT_NEAR(masses[0], 0.5 / 3, 1e-12);
  }
}

TEST(SourceMasses, OwnExperienceGrowsEvenlyIntoItsHalf) {
  const auto own = [](std::uint64_t paths) {
    return source_masses({{9, false}, {9, false}, {9, false}, {9, false}, {paths, true}})[4];
  };
  EXPECT_NEAR(own(5), 0.2, 1e-12);
  EXPECT_NEAR(own(15), 0.2, 1e-12) << "its equal part, as long as that is more";
  EXPECT_NEAR(own(20), 0.3, 1e-12);
  for (std::uint64_t paths = 0; paths < 40; ++paths) {
    EXPECT_LE(own(paths), own(paths + 1));
    EXPECT_LE(own(paths + 1) - own(paths), 0.05) << "no jumps";
  }
}

TEST(SourceMasses, OwnExperienceMayBeMoreThanHalf) {
  EXPECT_EQ(source_masses({{50, true}}), std::vector<double>{1});
  EXPECT_NEAR(source_masses({{50, true}, {1, false}})[0], 5 / 6.0, 1e-12);
}

TEST(SourceMasses, SumToOne) {
  for (std::uint64_t own = 0; own < 40; own += 3) {
    const std::vector<double> masses = source_masses({{own, true}, {3, false}, {17, false}});
    EXPECT_NEAR(std::accumulate(masses.begin(), masses.end(), 0.0), 1, 1e-12);
  }
}

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
}  // namespace kinship::fitting::source_masses_test
