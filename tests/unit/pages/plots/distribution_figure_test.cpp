#include "pages/plots/distribution_figure.hpp"

#include <gtest/gtest.h>

#include "tests/unit/pages/plots/known_paths.hpp"
#include "tests/unit/pages/plots/plot_values.hpp"

namespace kinship::plots::distribution_figure_test {
namespace {

using test::KnownPaths;

/// The same fitted at another time, under another id.
Distribution& keep(KnownPaths& known, std::uint8_t id, std::int64_t fitted_ms) {
  Distribution distribution = test::distribution_for("ur10e");
  distribution.id = Digest{{id}};
  distribution.fitted_ms = fitted_ms;
  return known.distributions[distribution.id] = distribution;
}

std::vector<std::int64_t> times_of(const std::vector<KeptDistribution>& kept) {
  std::vector<std::int64_t> times;
  for (const KeptDistribution& each : kept)
    times.push_back(each.summary.fitted_ms);
  return times;
}

std::vector<KeptDistribution> kept_of(KnownPaths& known, std::uint8_t id) {
  return kept_beside(known.distributions.at(Digest{{id}}), kinship::test::model_chain("ur10e"),
                     known.look_up());
}

TEST(KeptBeside, AreThoseOfThePlaceInTheOrderOfTheirFits) {
  KnownPaths known;
  keep(known, 1, 30);
  keep(known, 2, 10);
  keep(known, 3, 20).T_task_base = Eigen::Isometry3d::Identity();
  keep(known, 4, 40).state = DistributionState::Failed;
  const std::vector<KeptDistribution> kept = kept_of(known, 1);
  EXPECT_EQ(times_of(kept), (std::vector<std::int64_t>{10, 30}));
  EXPECT_EQ(kept[0].samples.hands.cols(), kSamplesOfKept);
  EXPECT_EQ(kept[0].samples.marginals.size(), 6U);
  EXPECT_EQ(times_of(kept_of(known, 3)), std::vector<std::int64_t>{20});
}

TEST(KeptBeside, OfManyAreTheNewestAndItself) {
  KnownPaths known;
  for (std::uint8_t i = 1; i <= kMaxKept + 4; ++i)
    keep(known, i, i);
  std::vector<std::int64_t> times = times_of(kept_of(known, 1));
  ASSERT_EQ(times.size(), kMaxKept);
  EXPECT_EQ(times.front(), 1);
  EXPECT_EQ(times[1], 6);
  times = times_of(kept_of(known, 20));
  EXPECT_EQ(times.front(), 5);
  EXPECT_EQ(times.back(), 20);
}

TEST(DistributionFigure, HasWhatItsTransferLost) {
  KnownPaths known;
  Distribution& distribution = keep(known, 1, 1);
  known.add("panda", test::turn_of_panda(1)).T_task_base =
      Eigen::Isometry3d(Eigen::Translation3d(5, 0, 0));
  known.descriptions[distribution.robot] = kinship::test::model_description("ur10e");
  distribution.sources[0].robot = kinship::test::model_chain("panda").digest();
  distribution.sources[0].paths_used = 1;
  const DistributionFigure figure = distribution_figure(distribution, known.look_up());
  EXPECT_EQ(figure.plot.label, "ur10e");
  EXPECT_EQ(figure.lost.sources[0].poses, 4U);
  EXPECT_EQ(figure.lost.places[0].cols(), 4);
  EXPECT_EQ(figure.kept.size(), 1U);
}

}  // namespace
}  // namespace kinship::plots::distribution_figure_test
