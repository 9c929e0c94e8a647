#include "robots/planning/configuration_sampler.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/planar_arm.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::samples_ahead_test {
namespace {

using test_support::at;
using test_support::square_bounds;

constexpr std::uint64_t kSeed = 23;

ConfigurationSampler guided_sampler() {
  test::PlanarArm arm;
  arm.lengths_m = {0.4, 0.3};
  arm.limit = 1;
  return {square_bounds(), arm.chain(),
          Mixture(Eigen::VectorXd::Ones(1), at(0, 0.7), {Eigen::MatrixXd::Identity(2, 2) * 0.04}),
          1.0};
}

/// What a search draws that draws when it needs a sample.
Eigen::VectorXd next(const ConfigurationSampler& sampler, std::uint64_t ordinal,
                     std::mt19937_64& generator) {
  constexpr std::uint64_t kPatience = 300;
  return sampler.sample(generator, ordinal < kPatience ? sampler.guided_fraction()
                                                       : std::min(sampler.guided_fraction(), 0.9));
}

TEST(SamplesAhead, AreThoseThatWouldBeDrawnOneByOne) {
  for (const ConfigurationSampler& sampler :
       {ConfigurationSampler(square_bounds()), guided_sampler()}) {
    std::mt19937_64 generator(kSeed), one_by_one(kSeed), choice(kSeed);
    SamplesAhead samples(sampler, generator);
    for (std::uint64_t used = 0; used < 1000;) {
      const std::uint64_t looked_at = 1 + choice() % SamplesAhead::kAhead;
      const std::uint64_t taken = choice() % (looked_at + 1);
      std::mt19937_64 ahead = one_by_one;
      for (std::uint64_t i = 0; i < looked_at; ++i)
        ASSERT_EQ(samples.at(i).q, next(sampler, used + i, ahead)) << used << " and " << i;
      for (std::uint64_t i = 0; i < taken; ++i)
        next(sampler, used + i, one_by_one);
      samples.use(taken);
      used += taken;
      EXPECT_EQ(samples.used(), used);
    }
  }
}

TEST(SamplesAhead, TheGeneratorStandsWhereItWouldOnceTheOthersAreGivenBack) {
  for (const ConfigurationSampler& sampler :
       {ConfigurationSampler(square_bounds()), guided_sampler()}) {
    std::mt19937_64 generator(kSeed), one_by_one(kSeed), choice(kSeed);
    SamplesAhead samples(sampler, generator);
    std::uint64_t used = 0;
    for (int i = 0; i < 400; ++i) {
      for (std::uint64_t left = choice() % 4; left > 0; --left) {
        samples.at(choice() % SamplesAhead::kAhead);
        samples.at(0);
        samples.use(1);
        next(sampler, used++, one_by_one);
      }
      if (choice() % 3 != 0)
        continue;
      samples.give_back();
      ASSERT_EQ(generator, one_by_one) << used;
    }
  }
}

TEST(SamplesAhead, WhatIsKnownOfASampleStaysUntilItIsUsed) {
  std::mt19937_64 generator(kSeed);
  const ConfigurationSampler sampler(square_bounds());
  SamplesAhead samples(sampler, generator);
  for (int i = 0; i < 50; ++i) {
    samples.at(5).nearest[1].index = 7;
    samples.use(5);
    EXPECT_EQ(samples.at(0).nearest[1].index, 7);
    samples.use(1);
    samples.at(7);
    samples.use(2);
    EXPECT_EQ(samples.at(7).nearest[1].index, 0) << "of a new one nothing is known";
    samples.use(8);
  }
}

}  // namespace
}  // namespace kinship::planning::samples_ahead_test
