#include "client/cli/distribution_commands.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace kinship::cli::fetch_command_test {
namespace {

std::string printed(const Distribution& distribution) {
  std::ostringstream out;
  print_distribution(distribution, out);
  return out.str();
}

TEST(PrintDistribution, DrawsTheScoresOfNumbersOfComponents) {
  Distribution distribution;
  distribution.component_scores = {{40, 0.5}, {20, 0.75}, {10, -0.25}};
  const std::string text = printed(distribution);
  EXPECT_NE(text.find("20           0.750  " + std::string(41, '#') + " chosen"), std::string::npos)
      << text;
  EXPECT_NE(text.find("40           0.500  " + std::string(31, '#') + "\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("10          -0.250  #\n"), std::string::npos) << text;
}

TEST(PrintDistribution, TellsTheBandwidthOfKernels) {
  Distribution distribution;
  distribution.configurations = 5000;
  distribution.mixture = Mixture(Eigen::Vector2d(0.5, 0.5), Eigen::MatrixXd::Zero(2, 2),
                                 {Eigen::Vector2d(0.04, 0.25).asDiagonal().toDenseMatrix()});
  const std::string text = printed(distribution);
  EXPECT_NE(text.find("kernels       2 in 2 dimensions, fitted to 5000 configurations\n"
                      "bandwidth     0.200 0.500, deviations of a kernel\n"),
            std::string::npos)
      << text;
}

TEST(PrintDistribution, DrawsNothingIfTheNumberWasGiven) {
  EXPECT_EQ(printed({}).find("HELD-OUT"), std::string::npos);
}

TEST(PrintDistribution, OneScoreIsTheBest) {
  Distribution distribution;
  distribution.component_scores = {{1, -3}};
  EXPECT_NE(printed(distribution).find("# chosen"), std::string::npos);
}

}  // namespace
}  // namespace kinship::cli::fetch_command_test
