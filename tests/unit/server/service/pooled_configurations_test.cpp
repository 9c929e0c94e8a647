#include "server/service/pooled_configurations.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kinship::service {
namespace {

transfer::TransferredPath transferred(Eigen::Index count, double value) {
  transfer::TransferredPath path;
  path.configurations = Eigen::MatrixXd::Constant(2, count, value);
  path.weights = Eigen::VectorXd::Ones(count);
  return path;
}

class Pooled : public testing::Test {
 protected:
  Pooled() {
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
  const Eigen::VectorXd weights = pool_.weights(true);
  EXPECT_NEAR(weights.head(2).sum(), 4, 1e-12);
  EXPECT_NEAR(weights.tail(6).sum(), 4, 1e-12);
}

TEST_F(Pooled, OtherwiseEveryConfigurationWeighsTheSame) {
  EXPECT_TRUE(pool_.weights(false).isApprox(Eigen::VectorXd::Ones(8)));
}

TEST_F(Pooled, WeightsSumToTheNumberOfConfigurations) {
  EXPECT_NEAR(pool_.weights(true).sum(), 8, 1e-12);
  EXPECT_NEAR(pool_.weights(false).sum(), 8, 1e-12);
}

TEST_F(Pooled, RefusesOtherShapes) {
  transfer::TransferredPath path = transferred(3, 1);
  path.weights = Eigen::VectorXd::Ones(2);
  EXPECT_THROW(pool_.add(path), std::invalid_argument);
  path.configurations = Eigen::MatrixXd::Ones(3, 2);
  EXPECT_THROW(pool_.add(path), std::invalid_argument);
}

TEST(PooledConfigurations, MayBeEmpty) {
  const PooledConfigurations pool(3);
  EXPECT_EQ(pool.configurations().cols(), 0);
  EXPECT_EQ(pool.weights(true).size(), 0);
}

}  // namespace
}  // namespace kinship::service
