#include "client/arguments/command_options.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

namespace kinship::arguments::profile_options_test {
namespace {

std::string profile_of(const std::string& line) {
  std::string profile = "default";
  CLI::App app;
  add_profile_options(app, profile);
  app.parse(line);
  return profile;
}

TEST(ProfileOptions, TheEstimatorIsAppendedWhereverItStands) {
  EXPECT_EQ(profile_of(""), "default");
  EXPECT_EQ(profile_of("--estimator kde"), "default,estimator=kde");
  EXPECT_EQ(profile_of("--profile paper --estimator gmm"), "paper,estimator=gmm");
  EXPECT_EQ(profile_of("--estimator kde --profile paper,tracks=2"), "paper,tracks=2,estimator=kde");
}

TEST(ProfileOptions, AnotherEstimatorIsRefused) {
  EXPECT_THROW(profile_of("--estimator knn"), CLI::ValidationError);
}

}  // namespace
}  // namespace kinship::arguments::profile_options_test
