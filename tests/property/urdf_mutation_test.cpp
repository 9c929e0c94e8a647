#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string>

#include "proto/types/limits.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/robots.hpp"

namespace kinship::urdf_mutation_test {
namespace {

constexpr std::uint64_t kSeed = 31;

/// Overwrites, deletes, copies or inserts something at a random place.
void mutate(std::string& text, std::mt19937_64& generator) {
  constexpr std::array<const char*, 12> kPieces = {
      "<",    "/>", "'", "\"", "nan", "1e309", "-", "<!--", "</link>", "<link name='x'>",
      "&#0;", "0x"};
  const auto below = [&](std::size_t limit) { return generator() % limit; };
  const std::size_t place = below(text.size());
  switch (below(4)) {
    case 0:
      text[place] = static_cast<char>(below(256));
      break;
    case 1:
      text.erase(place, 1 + below(40));
      break;
    case 2:
      text.insert(place, text.substr(below(text.size()), below(60)));
      break;
    default:
      text.insert(place, kPieces.at(below(kPieces.size())));
  }
}

TEST(UrdfMutation, EveryTextGivesAChainThatMovesOrAReason) {
  std::mt19937_64 generator(kSeed);
  const RobotDescription original = test::model_description("panda");
  int chains = 0;
  for (int i = 0; i < 1500; ++i) {
    RobotDescription mutant = original;
    for (std::size_t n = 1 + generator() % 3; n > 0; --n)
      mutate(mutant.urdf, generator);
    const auto chain = kinematics::read_chain(mutant);
    if (!chain) {
      EXPECT_FALSE(chain.error().message.empty());
      EXPECT_LE(chain.error().message.size(), kMaxMessageBytes);
      continue;
    }
    ++chains;
    const auto poses = link_poses(*chain, test::random_configuration(*chain, generator));
    for (const Eigen::Isometry3d& pose : poses)
      EXPECT_TRUE(pose.matrix().allFinite());
  }
  EXPECT_GT(chains, 50);
  EXPECT_LT(chains, 1450);
}

}  // namespace
}  // namespace kinship::urdf_mutation_test
