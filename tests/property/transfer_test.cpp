#include "server/transfer/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tuple>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/resample.hpp"
#include "robots/kinematics/urdf.hpp"
#include "server/transfer/take_over.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/transfer_path.hpp"
#include "tests/support/twins.hpp"

namespace kinship::transfer::transfer_test {
namespace {

using kinematics::resample;
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
  const ArmPair pair(source, target);

  TransferCounts sum;
  for (int i = 0; i < kPaths; ++i) {
    const Path path = random_path(source, generator);
    const auto transferred = test::transfer_path(path, pair, T_target_source, parameters, kSeed);
    const Eigen::MatrixXd resampled = resample(path, parameters);
    for (Eigen::Index c = 0; c < transferred.configurations.cols(); ++c) {
      const Eigen::VectorXd q = transferred.configurations.col(c);
      EXPECT_TRUE(target.within_limits(q));
      const Eigen::Isometry3d T_wanted =
          T_target_source *
          kinematics::T_base_transfer(source, resampled.col(transferred.pose_index[c]));
      EXPECT_LT((kinematics::T_base_transfer(target, q).matrix() - T_wanted.matrix()).norm(), 4e-6);
    }
    const TransferCounts& one = transferred.summary;
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

/// What the transfer of random paths of a UR10e makes of them for a twin at the same place.
class TransferToATwin : public testing::Test {
 protected:
  void transfer_to(const RobotDescription& twin) {
    const kinematics::Chain target = kinematics::read_chain(twin).value_or_throw();
    const ArmPair pair(source_, target);
    likeness_ = pair.likeness();
    std::mt19937_64 generator(kSeed);
    for (int i = 0; i < kTwinPaths; ++i) {
      const Path path = random_path(source_, generator);
      const Eigen::MatrixXd resampled = resample(path, {});
      const auto moved = test::transfer_path(path, pair, Eigen::Isometry3d::Identity(), {}, kSeed);
      sum_ += moved.summary;
      EXPECT_TRUE((moved.solution_index.array() == 0).all());
      for (Eigen::Index c = 0; c < moved.configurations.cols(); ++c)
        check(resampled.col(moved.pose_index[c]), moved.configurations.col(c), target);
    }
    EXPECT_EQ(sum_.poses, sum_.poses_solved + sum_.outside_limits + sum_.not_converged);
    EXPECT_EQ(sum_.configurations, sum_.poses_solved);
  }

  kinematics::Chain source_ = test::model_chain("ur10e");
  kinematics::ArmLikeness likeness_ = kinematics::ArmLikeness::Different;
  TransferCounts sum_;

 private:
  static constexpr int kTwinPaths = 40;

  /// The transfer frame is exactly where it was, and the arm has the posture it had.
  void check(const Eigen::VectorXd& q_source, const Eigen::VectorXd& q,
             const kinematics::Chain& target) {
    EXPECT_TRUE(target.within_limits(q));
    const Eigen::Isometry3d T_wanted = kinematics::T_base_transfer(source_, q_source);
    EXPECT_LT((kinematics::T_base_transfer(target, q).matrix() - T_wanted.matrix()).norm(), 4e-6);
    double squared = 0;
    for (Eigen::Index j = 0; j < q.size(); ++j)
      squared += std::pow(std::remainder(q[j] - q_source[j], 2 * std::numbers::pi), 2);
    EXPECT_LE(std::sqrt(squared), kFarthestPolish + 1e-9);
  }
};

TEST_F(TransferToATwin, ACopyTakesEveryWaypoint) {
  transfer_to(test::calibrated_twin(test::model_description("ur10e"), "copy", 1e-12, kSeed));
  EXPECT_EQ(likeness_, kinematics::ArmLikeness::Exact);
  EXPECT_EQ(sum_.poses_solved, sum_.poses);
}

TEST_F(TransferToATwin, ACalibratedOneTakesNearlyAllInTheirPosture) {
  transfer_to(test::calibrated_twin(test::model_description("ur10e"), "twin", 3e-4, kSeed));
  EXPECT_EQ(likeness_, kinematics::ArmLikeness::Near);
  EXPECT_GT(sum_.poses_solved * 100, sum_.poses * 94)
      << sum_.poses_solved << " of " << sum_.poses << ", " << sum_.not_converged
      << " not converged, " << sum_.outside_limits << " outside limits";
}

TEST_F(TransferToATwin, OneWithNarrowLimitsTakesThemTurnedIntoThose) {
  transfer_to(test::limited_twin(test::model_description("ur10e"), "narrow", 3.14));
  EXPECT_EQ(likeness_, kinematics::ArmLikeness::Exact);
  EXPECT_GT(sum_.poses_solved * 100, sum_.poses * 98);
}

}  // namespace
}  // namespace kinship::transfer::transfer_test
