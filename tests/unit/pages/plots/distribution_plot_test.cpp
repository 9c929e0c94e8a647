#include "pages/plots/distribution_plot.hpp"

#include <gtest/gtest.h>

#include "proto/types/failure.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/pages/plots/plot_values.hpp"

namespace kinship::plots::distribution_plot_test {
namespace {

DrawnRobot drawn(const std::string& model) {
  return drawn_robot(kinship::test::model_description(model));
}

TEST(HeaviestComponents, FallAndAddUp) {
  const auto components = heaviest_components(*test::distribution_for("panda").mixture);
  ASSERT_EQ(components.size(), 2U);
  EXPECT_DOUBLE_EQ(components[0].weight, 0.75);
  EXPECT_DOUBLE_EQ(components[1].weight, 0.25);
  EXPECT_DOUBLE_EQ(components[0].cumulated, 0.75);
  EXPECT_DOUBLE_EQ(components[1].cumulated, 1);
}

TEST(HeaviestComponents, OfManyKernelsAreSome) {
  constexpr Eigen::Index kKernels = 1000;
  const Mixture kernels(Eigen::VectorXd::Constant(kKernels, 1.0 / kKernels),
                        Eigen::MatrixXd::Zero(2, kKernels), {Eigen::Matrix2d::Identity()});
  const auto components = heaviest_components(kernels);
  ASSERT_EQ(components.size(), kMaxComponentsShown);
  EXPECT_NEAR(components.back().cumulated, 0.2, 1e-12);
}

TEST(DistributionPlot, PlacesTheHandOfEverySampleInTheTaskFrame) {
  Distribution distribution = test::distribution_for("ur10e");
  const DistributionPlot here = plot_of(distribution, drawn("ur10e"));
  ASSERT_EQ(here.samples.hands.cols(), static_cast<Eigen::Index>(kSamplesShown));
  const Eigen::Vector3d shift(1, 2, 3);
  distribution.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(shift));
  const DistributionPlot there = plot_of(distribution, drawn("ur10e"));
  EXPECT_TRUE((here.samples.hands.colwise() + shift).isApprox(there.samples.hands, 1e-12));
  EXPECT_TRUE((here.postures[0].bones[0].from + shift).isApprox(there.postures[0].bones[0].from));
  EXPECT_EQ(here.label, "ur10e");
  EXPECT_FALSE(here.shapes.empty());
}

TEST(DistributionPlot, ANarrowMixturesHandIsAtItsMeans) {
  Distribution distribution = test::distribution_for("ur10e");
  const Eigen::MatrixXd means = distribution.mixture->means().col(1);
  distribution.mixture =
      Mixture(Eigen::VectorXd::Ones(1), means, {1e-12 * Eigen::MatrixXd::Identity(6, 6)});
  const DistributionPlot plot = plot_of(distribution, drawn("ur10e"));
  const Eigen::Vector3d hand =
      kinematics::T_base_transfer(kinship::test::model_chain("ur10e"), means.col(0)).translation();
  EXPECT_LT((plot.samples.hands.colwise() - hand).colwise().norm().maxCoeff(), 1e-4);
}

TEST(DistributionPlot, StandsInTheMeansOfTheHeaviestComponents) {
  const DistributionPlot plot = plot_of(test::distribution_for("ur10e"), drawn("ur10e"));
  ASSERT_EQ(plot.postures.size(), 2U);
  EXPECT_DOUBLE_EQ(plot.postures[0].weight, 0.75);
  EXPECT_DOUBLE_EQ(plot.postures[1].weight, 0.25);
  EXPECT_FALSE(plot.postures[0].bones.empty());
}

void expect_failure(const Distribution& distribution, const char* model, ErrorCode code,
                    const std::string& words) {
  try {
    plot_of(distribution, drawn(model));
    FAIL() << "a plot of " << words;
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.code(), code);
    EXPECT_NE(std::string(failure.what()).find(words), std::string::npos) << failure.what();
  }
}

TEST(DistributionPlot, WithoutAMixtureThereIsNothingToPlot) {
  Distribution failed = test::distribution_for("ur10e");
  failed.mixture.reset();
  failed.state = DistributionState::Failed;
  failed.reason = "every pose is out of reach";
  expect_failure(failed, "ur10e", ErrorCode::NotFound, "every pose is out of reach");
}

TEST(DistributionPlot, AnotherRobotIsRefused) {
  expect_failure(test::distribution_for("ur10e"), "panda", ErrorCode::InvalidInput, "'panda'");
}

}  // namespace
}  // namespace kinship::plots::distribution_plot_test
