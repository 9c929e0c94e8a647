#include "client/experiments/studies/instance_random.hpp"

#include <algorithm>
#include <cstdio>

namespace kinship::experiments {

std::mt19937_64 generator_for(const InstanceKey& key, Use use) {
  constexpr unsigned kHalf = 32;
  std::seed_seq sequence{static_cast<std::uint32_t>(key.seed),
                         static_cast<std::uint32_t>(key.seed >> kHalf), key.index, key.draw,
                         static_cast<std::uint32_t>(use)};
  return std::mt19937_64(sequence);
}

std::uint64_t planner_seed(const InstanceKey& key) {
  return generator_for(key, Use::Planner)() >> 1U;
}

std::string instance_name(std::string_view task, const InstanceKey& key) {
  char number[16];
  std::snprintf(number, sizeof number, "%04u", key.index);
  std::string name = std::string(task) + "-" + std::to_string(key.seed) + "-" + number;
  if (key.draw > 0)
    name += "." + std::to_string(key.draw);
  return name;
}

double Noise::operator()(double deviation) {
  constexpr double kCut = 2.5;
  return deviation * std::clamp(normal_(generator_), -kCut, kCut);
}

}  // namespace kinship::experiments
