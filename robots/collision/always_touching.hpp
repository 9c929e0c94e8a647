#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <random>
#include <type_traits>

#include "robots/kinematics/chain.hpp"

namespace kinship::collision {

/// The pairs of things that touch wherever a robot goes: in at least `least` of `samples` random
/// configurations within the limits. Seeded: equal input, equal answers.
/// \param touching_at  configuration -> the set of pairs that touch there.
template <typename TouchingAt>
auto always_touching(const kinematics::Chain& chain, int samples, int least,
                     const TouchingAt& touching_at) {
  using Pairs = std::invoke_result_t<TouchingAt, const Eigen::VectorXd&>;
  constexpr std::uint64_t kSeed = 1;
  std::mt19937_64 generator(kSeed);
  std::map<typename Pairs::value_type, int> touches;
  Eigen::VectorXd q(chain.dof());
  for (int sample = 0; sample < samples; ++sample) {
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    for (const auto& pair : touching_at(q))
      ++touches[pair];
  }
  Pairs always;
  for (const auto& [pair, count] : touches)
    if (count >= least)
      always.insert(pair);
  return always;
}

}  // namespace kinship::collision
