#include "server/fitting/pooled_configurations.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

namespace kinship::fitting::pooled_configurations_test {
namespace {

std::shared_ptr<transfer::TransferredPath> transferred(Eigen::Index count, double value) {
  auto path = std::make_shared<transfer::TransferredPath>();
  path->configurations = Eigen::MatrixXd::Constant(2, count, value);
  path->weights = Eigen::VectorXd::Ones(count);
  return path;
}

DensityParameters weighing(bool equal_path_weights, Weighting weighting = Weighting::Paths) {
  DensityParameters parameters;
  parameters.equal_path_weights = equal_path_weights;
  parameters.weighting = weighting;
  return parameters;
}

class Pooled : public testing::Test {
 protected:
  Pooled() {
    pool_.begin_source(false);
    pool_.add(transferred(2, 1));
    pool_.add(transferred(0, 0));  // a path of which nothing could be used
    pool_.add(transferred(6, 2));
  }
  PooledConfigurations pool_{2};
};

TEST_F(Pooled, KeepsTheOrderOfAddition) {
  ASSERT_EQ(pool_.size(), 8);
  const Eigen::MatrixXd configurations = pool_.configurations();
  EXPECT_TRUE((configurations.leftCols(2).array() == 1).all());
  EXPECT_TRUE((configurations.rightCols(6).array() == 2).all());
}

TEST_F(Pooled, EqualPathWeightsMakeEveryPathWeighTheSame) {
  const Eigen::VectorXd weights = pool_.weights(weighing(true));
  EXPECT_NEAR(weights.head(2).sum(), 4, 1e-12);
  EXPECT_NEAR(weights.tail(6).sum(), 4, 1e-12);
}

TEST_F(Pooled, OtherwiseEveryConfigurationWeighsTheSame) {
  EXPECT_TRUE(pool_.weights(weighing(false)).isApprox(Eigen::VectorXd::Ones(8)));
}

TEST_F(Pooled, WeightsSumToTheNumberOfConfigurations) {
  EXPECT_NEAR(pool_.weights(weighing(true)).sum(), 8, 1e-12);
  EXPECT_NEAR(pool_.weights(weighing(false)).sum(), 8, 1e-12);
}

TEST_F(Pooled, RefusesOtherShapes) {
  const auto path = transferred(3, 1);
  path->weights = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(pool_.add(path), std::invalid_argument);
  path->configurations = Eigen::MatrixXd::Ones(3, 2);
  EXPECT_THROW(pool_.add(path), std::invalid_argument);
}

TEST(PooledConfigurations, APathBelongsToASource) {
  PooledConfigurations pool(2);
  EXPECT_THROW(pool.add(transferred(1, 0)), std::logic_error);
}

TEST(PooledConfigurations, SourcesWeighTheSameHoweverManyPathsTheyHave) {
  PooledConfigurations pool(2);
  pool.begin_source(false);
  for (int i = 0; i < 20; ++i)
    pool.add(transferred(3, 1));
  pool.begin_source(false);
  for (int i = 0; i < 5; ++i)
    pool.add(transferred(i == 0 ? 9 : 1, 2));
  pool.begin_source(false);  // nothing of this one could be used
  pool.add(transferred(0, 0));
  const Eigen::VectorXd weights = pool.weights(weighing(true, Weighting::Sources));
  EXPECT_NEAR(weights.sum(), 73, 1e-9);
  EXPECT_NEAR(weights.head(60).sum(), 36.5, 1e-9);
  EXPECT_NEAR(weights.segment(60, 9).sum(), weights[69], 1e-9) << "paths of a source still do";
  const std::vector<double> masses = pool.masses(weights);
  ASSERT_EQ(masses.size(), 3U);
  EXPECT_NEAR(masses[0], 0.5, 1e-12);
  EXPECT_NEAR(masses[1], 0.5, 1e-12);
  EXPECT_EQ(masses[2], 0);

  const std::vector<double> by_paths = pool.masses(pool.weights(weighing(true)));
  EXPECT_NEAR(by_paths[0], 0.8, 1e-12);
  const std::vector<double> by_configurations = pool.masses(pool.weights(weighing(false)));
  EXPECT_NEAR(by_configurations[0], 60.0 / 73, 1e-12);
}

TEST(PooledConfigurations, NoRoundingGivesASourceMoreThanAll) {
  PooledConfigurations pool(2);
  pool.begin_source(false);
  for (int i = 0; i < 200; ++i) {
    pool.add(transferred(1 + i % 7, 1));
    ASSERT_EQ(pool.masses(pool.weights(weighing(true))).at(0), 1) << i;
  }
}

TEST(PooledConfigurations, MayBeEmpty) {
  const PooledConfigurations pool(3);
  EXPECT_TRUE(pool.masses(pool.weights(weighing(true, Weighting::Sources))).empty());
  EXPECT_EQ(pool.configurations().cols(), 0);
  EXPECT_EQ(pool.weights(weighing(true)).size(), 0);
}

}  // namespace
}  // namespace kinship::fitting::pooled_configurations_test
