#include "proto/types/profile_text.hpp"

#include <gtest/gtest.h>

namespace kinship::profile_text_test {
namespace {

TEST(ProfileText, ANameAloneIsThatProfile) {
  EXPECT_EQ(profile_from_text("default").value_or_throw(), *find_profile("default"));
  EXPECT_EQ(profile_from_text("paper").value_or_throw(), *find_profile("paper"));
}

TEST(ProfileText, ChangesWhatItNamesAndNothingElse) {
  Profile expected = *find_profile("paper");
  expected.name = "paper,components=20,covariance_floor=0.0025,avoid_self_collision=1";
  expected.density.components = 20;
  expected.density.covariance_floor = 0.0025;
  expected.transfer.avoid_self_collision = true;
  EXPECT_EQ(profile_from_text(expected.name).value_or_throw(), expected);
}

TEST(ProfileText, EveryOptionCanBeChanged) {
  for (const std::string& option : profile_options()) {
    const Profile zero = profile_from_text("default," + option + "=0")
                             ? *profile_from_text("default," + option + "=0")
                             : *find_profile("default");
    const Profile one = profile_from_text("default," + option + "=1")
                            ? *profile_from_text("default," + option + "=1")
                            : *find_profile("paper");
    EXPECT_FALSE(zero.transfer == one.transfer && zero.density == one.density) << option;
  }
}

TEST(ProfileText, ComponentsAreChosenByAuto) {
  EXPECT_EQ(profile_from_text("default,components=auto")->density.components, 0);
  EXPECT_EQ(profile_from_text("paper,components=0")->density.components, 0);
  EXPECT_FALSE(profile_from_text("default,tracks=auto"));
}

TEST(ProfileText, APriorIsChosenByAutoAndThePaperHasNone) {
  EXPECT_EQ(profile_from_text("default")->density.prior, kChosenPrior);
  EXPECT_EQ(profile_from_text("paper")->density.prior, 0);
  EXPECT_EQ(profile_from_text("paper,prior=auto")->density.prior, kChosenPrior);
  EXPECT_EQ(profile_from_text("default,prior=40")->density.prior, 40);
  EXPECT_FALSE(profile_from_text("default,prior=-1"));
}

TEST(ProfileText, EstimatorIsAWord) {
  EXPECT_EQ(profile_from_text("default,estimator=kde")->density.estimator, Estimator::Kernels);
  EXPECT_EQ(profile_from_text("default,estimator=kde,estimator=gmm")->density.estimator,
            Estimator::Mixture);
  EXPECT_EQ(profile_from_text("default,estimator=1").error().message,
            "profile 'default,estimator=1': 'estimator=1' is not gmm or kde");
  EXPECT_FALSE(profile_from_text("default,estimator"));
}

TEST(ProfileText, YesAndNoAreOneAndZero) {
  EXPECT_FALSE(profile_from_text("default,take_over=no")->transfer.take_over);
  EXPECT_FALSE(profile_from_text("default,take_over=0")->transfer.take_over);
  EXPECT_TRUE(profile_from_text("default,take_over=no,take_over=yes")->transfer.take_over);
  EXPECT_TRUE(profile_from_text("default,take_over=1")->transfer.take_over);
  EXPECT_EQ(profile_from_text("default,take_over=on").error().message,
            "profile 'default,take_over=on': 'take_over=on' is not yes or no, nor 1 or 0");
  EXPECT_FALSE(profile_from_text("default,take_over=2"));
  EXPECT_FALSE(profile_from_text("default,tracks=yes")) << "a number is none";
}

TEST(ProfileText, RefusesWithOptionValueAndLimits) {
  const auto message = [](const char* text) { return profile_from_text(text).error().message; };
  EXPECT_EQ(message("best"), "profile 'best': it does not begin with default or paper");
  EXPECT_EQ(message(""), "profile '': it does not begin with default or paper");
  EXPECT_EQ(message("default,K=20"), "profile 'default,K=20': there is no option 'K'");
  EXPECT_EQ(message("default,components=1001"),
            "profile 'default,components=1001': 'components=1001' is not a whole number from 0 to "
            "1000");
  for (const char* bad :
       {"default,", "default,components", "default,components=", "default,tracks=1.5",
        "default,components=nan", "default,min_distance=1e9", "default,components=20 ",
        "default,components=20,,"})
    EXPECT_FALSE(profile_from_text(bad)) << bad;
}

}  // namespace
}  // namespace kinship::profile_text_test
