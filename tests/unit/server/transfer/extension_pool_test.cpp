#include "server/transfer/extension_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "server/transfer/transfer.hpp"
#include "tests/support/one_by_one.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/transfer_path.hpp"

namespace kinship::transfer::extension_pool_test {
namespace {

using test::transfer_path;

constexpr std::uint64_t kSeed = 8;
constexpr int kPaths = 9;

/// Paths of different lengths, filtered differently, some of them partly out of reach.
struct Group {
  Group(const std::string& from, const std::string& to)
      : source(test::model_chain(from)), target(test::model_chain(to)) {
    std::mt19937_64 generator(4);
    for (int i = 0; i < kPaths; ++i) {
      const Eigen::VectorXd middle = test::random_configuration(source, generator);
      Eigen::MatrixXd waypoints(source.dof(), 3);
      for (Eigen::Index column = 0; column < waypoints.cols(); ++column)
        waypoints.col(column) =
            middle + 0.1 * (1 + i) * (test::random_configuration(source, generator) - middle) / 2;
      paths.emplace_back(waypoints);
      const double most = 0.3 * i;
      filters.push_back(
          {i % 3 == 1 ? ConfigurationFilter(
                            test::one_by_one([most](const auto& q) { return q[1] < most; }))
                      : ConfigurationFilter(),
           i % 4 == 2
               ? ConfigurationFilter(test::one_by_one([](const auto& q) { return q[2] > -0.5; }))
               : ConfigurationFilter()});
    }
  }

  TransferredPath alone(std::size_t i) const {
    return transfer_path(paths[i], pair, Eigen::Isometry3d::Identity(), parameters, kSeed,
                         filters[i]);
  }

  /// All paths in groups of so many.
  std::vector<TransferredPath> in_groups_of(std::size_t size) const {
    std::vector<TransferredPath> results;
    for (std::size_t first = 0; first < paths.size(); first += size) {
      std::vector<PathToTransfer> group;
      for (std::size_t i = first; i < std::min(first + size, paths.size()); ++i)
        group.push_back({paths[i], Eigen::Isometry3d::Identity(), filters[i]});
      for (TransferredPath& path : transfer_paths(group, pair, parameters, kSeed))
        results.push_back(std::move(path));
    }
    return results;
  }

  kinematics::Chain source, target;
  ArmPair pair{source, target};
  TransferParameters parameters{.pose_spacing = 0.4};
  std::vector<Path> paths;
  std::vector<Filters> filters;
};

class ExtensionPoolBetween : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(ExtensionPoolBetween, APathBecomesTheSameAloneAndInAnyGroup) {
  const Group group(GetParam().first, GetParam().second);
  std::vector<TransferredPath> alone;
  std::uint64_t kept = 0, tried = 0;
  for (std::size_t i = 0; i < group.paths.size(); ++i) {
    alone.push_back(group.alone(i));
    kept += alone.back().summary.tracks_kept;
    tried += alone.back().summary.tracks_tried;
  }
  EXPECT_GT(kept, 0U);
  EXPECT_GT(tried, kept);
  for (const std::size_t size : {1U, 2U, 5U, 9U}) {
    const std::vector<TransferredPath> together = group.in_groups_of(size);
    ASSERT_EQ(together.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      ASSERT_EQ(together[i].pose_index.size(), alone[i].pose_index.size()) << i << " of " << size;
      EXPECT_EQ(together[i].configurations, alone[i].configurations) << i << " of " << size;
      EXPECT_EQ(together[i].pose_index, alone[i].pose_index);
      EXPECT_EQ(together[i].solution_index, alone[i].solution_index);
      EXPECT_EQ(together[i].summary.tracks_tried, alone[i].summary.tracks_tried);
      EXPECT_EQ(together[i].summary.tracks_through, alone[i].summary.tracks_through);
      EXPECT_EQ(together[i].summary.filter_checks, alone[i].summary.filter_checks);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, ExtensionPoolBetween,
                         testing::Values(std::pair("ur10e", "panda"), std::pair("panda", "ur10e"),
                                         std::pair("planar_5r_a", "planar_7r_c")),
                         [](const auto& instance) {
                           return std::string(instance.param.first) + "_to_" +
                                  instance.param.second;
                         });

TEST(TransferPaths, AGroupHoldsPathsThatAreTakenOverToo) {
  const Group group("panda", "panda");
  Eigen::Isometry3d beside = Eigen::Isometry3d::Identity();
  beside.translation().x() = 0.1;
  const std::vector<PathToTransfer> paths = {
      {group.paths[0], beside, group.filters[0]},
      {group.paths[1], Eigen::Isometry3d::Identity(), group.filters[1]},
      {group.paths[2], beside, group.filters[2]}};
  const std::vector<TransferredPath> moved =
      transfer_paths(paths, group.pair, group.parameters, kSeed);
  ASSERT_EQ(moved.size(), 3U);
  EXPECT_EQ(moved[1].configurations, group.alone(1).configurations);
  EXPECT_EQ(moved[1].summary.tracks_tried, 0U);
  EXPECT_GT(moved[0].summary.tracks_tried, 0U);
  EXPECT_EQ(moved[2].configurations, transfer_path(group.paths[2], group.pair, beside,
                                                   group.parameters, kSeed, group.filters[2])
                                         .configurations);
}

TEST(TransferPaths, OfAnEmptyGroupNothingComes) {
  const Group group("panda", "ur10e");
  EXPECT_TRUE(transfer_paths({}, group.pair, group.parameters, kSeed).empty());
}

}  // namespace
}  // namespace kinship::transfer::extension_pool_test
