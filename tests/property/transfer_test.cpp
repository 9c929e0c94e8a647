#include "server/transfer/transfer.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <tuple>

#include "robots/kinematics/forward_kinematics.hpp"
#include "server/transfer/resample.hpp"
#include "tests/support/robots.hpp"

namespace kinship::transfer {
namespace {

constexpr std::uint64_t kSeed = 17;
constexpr int kPaths = 10;

Path random_path(const kinematics::Chain& chain, std::mt19937_64& generator) {
  Eigen::MatrixXd waypoints(chain.dof(), 3);
  for (Eigen::Index column = 0; column < waypoints.cols(); ++column)
    waypoints.col(column) = test::random_configuration(chain, generator);
  return Path(waypoints);
}

class TransferBetweenModels : public testing::TestWithParam<std::tuple<std::string, std::string>> {
};

TEST_P(TransferBetweenModels, KeepsThePoseOfTheTransferFrameInTheCommonFrame) {
  const kinematics::Chain source = test::model_chain(std::get<0>(GetParam()));
  const kinematics::Chain target = test::model_chain(std::get<1>(GetParam()));
  std::mt19937_64 generator(kSeed);
  Eigen::Isometry3d T_target_source(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ()));
  T_target_source.translation() << 0.1, -0.05, 0.08;
  const TransferParameters parameters{.pose_spacing = 1.0};

  TransferSummary sum;
  for (int i = 0; i < kPaths; ++i) {
    const Path path = random_path(source, generator);
    const auto transferred =
        transfer_path(path, source, target, T_target_source, parameters, kSeed);
    const Eigen::MatrixXd resampled = resample(path, parameters);
    for (Eigen::Index c = 0; c < transferred.configurations.cols(); ++c) {
      const Eigen::VectorXd q = transferred.configurations.col(c);
      EXPECT_TRUE(target.within_limits(q));
      const Eigen::Isometry3d T_wanted =
          T_target_source *
          kinematics::T_base_transfer(source, resampled.col(transferred.pose_index[c]));
      EXPECT_LT((kinematics::T_base_transfer(target, q).matrix() - T_wanted.matrix()).norm(), 4e-6);
    }
    const TransferSummary& one = transferred.summary;
    EXPECT_EQ(one.poses, static_cast<std::uint64_t>(resampled.cols()));
    EXPECT_EQ(one.poses,
              one.poses_solved + one.out_of_reach + one.outside_limits + one.not_converged);
    sum.poses += one.poses;
    sum.poses_solved += one.poses_solved;
  }
  EXPECT_GT(sum.poses_solved, sum.poses / 10);
}

INSTANTIATE_TEST_SUITE_P(Pairs, TransferBetweenModels,
                         testing::Combine(testing::Values("panda", "iiwa14", "ur10e"),
                                          testing::Values("panda", "iiwa14", "ur10e")),
                         [](const auto& instance) {
                           return std::get<0>(instance.param) + "_to_" +
                                  std::get<1>(instance.param);
                         });

}  // namespace
}  // namespace kinship::transfer
