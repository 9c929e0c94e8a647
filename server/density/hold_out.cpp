#include "server/density/hold_out.hpp"

#include <algorithm>
#include <numeric>
#include <random>

namespace kinship::density {

std::vector<std::uint8_t> held_out_paths(std::uint32_t count, std::uint64_t seed,
                                         std::uint32_t fold) {
  std::vector<std::uint8_t> held_out(count, 0);
  if (count < kMinPathsToScore)
    return held_out;
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937_64 generator(seed);
  std::shuffle(order.begin(), order.end(), generator);
  const auto border = [count](std::uint64_t part) {
    return static_cast<std::uint32_t>(part * count / kFolds);
  };
  for (std::uint32_t i = border(fold); i < border(fold + 1); ++i)
    held_out[order[i]] = 1;
  return held_out;
}

std::vector<std::vector<std::uint8_t>> folds_of(std::uint32_t paths, std::uint64_t seed) {
  std::vector<std::vector<std::uint8_t>> folds;
  if (paths >= kMinPathsToScore) {
    for (std::uint32_t fold = 0; fold < (paths <= kFewPaths ? kFolds : 1); ++fold)
      folds.push_back(held_out_paths(paths, seed, fold));
    return folds;
  }
  for (std::uint32_t path = 0; paths > 1 && path < paths; ++path) {
    folds.emplace_back(paths, std::uint8_t{0});
    folds.back()[path] = 1;
  }
  return folds;
}

}  // namespace kinship::density
