#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>

/// Random numbers of instances: which are equal for whom.
namespace kinship::experiments {

/// One draw of an instance; the next draw is made where a robot cannot start or end the one before.
struct InstanceKey {
  std::uint64_t seed = 0;
  std::uint32_t index = 0;
  std::uint32_t draw = 0;
};

/// Independent random numbers for each use of an instance.
enum class Use : std::uint32_t { Scene, Start, Planner };

std::mt19937_64 generator_for(const InstanceKey& key, Use use);

/// Of Problem::seed; fits a signed integer.
std::uint64_t planner_seed(const InstanceKey& key);

/// "<task>-<seed>-<index>", and ".<draw>" from the second draw on.
std::string instance_name(std::string_view task, const InstanceKey& key);

/// Normal noise, cut at 2.5 standard deviations so that objects do not grow into each other.
class Noise {
 public:
  explicit Noise(std::mt19937_64& generator) : generator_(generator) {}

  double operator()(double deviation);

 private:
  std::mt19937_64& generator_;
  std::normal_distribution<double> normal_;
};

}  // namespace kinship::experiments
