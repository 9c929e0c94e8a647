#include <benchmark/benchmark.h>

#include <random>
#include <string>

#include "robots/kinematics/same_arm.hpp"
#include "tests/support/robots.hpp"

// The same-arm test of the model robots: with themselves (every configuration is compared) and
// with an arm whose second joint stands 20 mm off.
namespace kinship {
namespace {

kinematics::Chain displaced(const kinematics::Chain& chain) {
  kinematics::ChainParts parts;
  parts.joints = chain.joints();
  parts.joints[1].T_previous_joint.translation().x() += 0.02;
  parts.T_last_tip = chain.T_last_tip();
  return kinematics::Chain(std::move(parts));
}

void same_arm(benchmark::State& state, const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  for (auto step : state)
    benchmark::DoNotOptimize(compare_arms(chain, chain));
}

void different_arm(benchmark::State& state, const std::string& robot) {
  const kinematics::Chain chain = test::model_chain(robot);
  const kinematics::Chain other = displaced(chain);
  for (auto step : state)
    benchmark::DoNotOptimize(compare_arms(chain, other));
}

BENCHMARK_CAPTURE(same_arm, panda, std::string("panda"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(same_arm, ur10e, std::string("ur10e"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(different_arm, panda, std::string("panda"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(different_arm, ur10e, std::string("ur10e"))->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace kinship

BENCHMARK_MAIN();
