#include "robots/collision/pair_sampling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

#include "robots/collision/collision_world.hpp"
#include "tests/support/robots.hpp"
#include "tests/unit/robots/collision/toy_arm.hpp"

namespace kinship::collision::pair_sampling_test {
namespace {

using test_support::toy_chain;
using test_support::toy_shapes;

const SampledPair& pair_of(const std::vector<SampledPair>& pairs, int a, int b) {
  const auto found = std::ranges::find_if(
      pairs, [&](const SampledPair& pair) { return pair.link_a == a && pair.link_b == b; });
  if (found == pairs.end())
    throw std::runtime_error("no such pair");
  return *found;
}

TEST(PairSampling, SeesWhatAlwaysTouches) {
  const kinematics::Chain chain = toy_chain(3);
  geometry::RobotShapes shapes = toy_shapes(3);
  // A ball about the first joint as large as the first link and a half: link 2 begins in it,
  // always.
  shapes.shapes.push_back({0, SphereShape{0.7}});
  const std::vector<SampledPair> pairs = sample_pairs(chain, shapes, {.samples = 2000, .seed = 3});
  EXPECT_EQ(pair_of(pairs, 0, 2).touched, 2000U);
  EXPECT_TRUE(pair_of(pairs, 0, 1).is_adjacent);
  EXPECT_TRUE(pair_of(pairs, 1, 2).is_adjacent);
  EXPECT_FALSE(pair_of(pairs, 1, 3).is_adjacent);
}

TEST(PairSampling, ARareCollisionIsSeen) {
  const kinematics::Chain chain = toy_chain(3);
  geometry::RobotShapes shapes = toy_shapes(3);
  // A crumb out where only a nearly stretched arm comes.
  shapes.shapes.push_back({0, SphereShape{0.02}, test_support::shift(1.36)});
  const std::vector<SampledPair> pairs =
      sample_pairs(chain, shapes, {.samples = 20'000, .seed = 3});
  const SampledPair& rare = pair_of(pairs, 0, 3);
  EXPECT_GT(rare.touched, 0U);
  EXPECT_LT(rare.touched, 400U);  // so rare that the lanes are asked
  EXPECT_TRUE(rare.touches_at_zero);
  EXPECT_FALSE(pair_of(pairs, 1, 3).touches_at_zero);
}

TEST(PairSampling, CountsWhatAWorldFinds) {
  const RobotDescription description = test::model_description("panda");
  const kinematics::Chain chain = test::model_chain("panda");
  geometry::RobotShapes shapes =
      geometry::read_shapes(kinematics::read_model(description).value_or_throw()).value_or_throw();
  constexpr std::uint64_t kSamples = 600, kSeed = 5;
  const std::vector<SampledPair> pairs =
      sample_pairs(chain, shapes, {.samples = kSamples, .seed = kSeed});
  // A world that excepts nothing but neighbours, asked about the same configurations.
  shapes.never_colliding = {{0, static_cast<int>(chain.links().size()) - 1}};
  CollisionWorld world(chain, shapes, {});
  std::mt19937_64 generator(kSeed);
  std::map<std::pair<std::string, std::string>, std::uint64_t> touched;
  for (std::uint64_t sample = 0; sample < kSamples; ++sample) {
    Eigen::VectorXd q(chain.dof());
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    std::set<std::pair<std::string, std::string>> now;
    for (const auto& [a, b] : world.find_contacts(q))
      now.insert(std::minmax(a, b));
    for (const auto& names : now)
      ++touched[names];
  }
  std::size_t compared = 0;
  const auto name = [&](int link) { return chain.links()[static_cast<std::size_t>(link)].name; };
  for (const SampledPair& pair : pairs) {
    const auto found = touched.find(std::minmax(name(pair.link_a), name(pair.link_b)));
    if (found == touched.end())
      continue;
    ++compared;
    EXPECT_EQ(pair.touched, found->second) << name(pair.link_a) << ' ' << name(pair.link_b);
  }
  EXPECT_EQ(compared, touched.size());
  EXPECT_GT(compared, 0U);
}

TEST(PairSampling, EqualSeedsGiveEqualAnswersAndProgressEndsAtOne) {
  const kinematics::Chain chain = toy_chain(4);
  const geometry::RobotShapes shapes = toy_shapes(4);
  double last = 0;
  const auto counts_with = [&](std::uint64_t seed) {
    std::vector<std::uint64_t> counts;
    for (const SampledPair& pair :
         sample_pairs(chain, shapes, {.samples = 1000, .seed = seed, .progress = [&](double part) {
                                        EXPECT_GE(part, 0);
                                        last = part;
                                      }}))
      counts.push_back(pair.touched);
    return counts;
  };
  EXPECT_EQ(counts_with(1), counts_with(1));
  EXPECT_NE(counts_with(1), counts_with(2));
  EXPECT_EQ(last, 1);
}

}  // namespace
}  // namespace kinship::collision::pair_sampling_test
