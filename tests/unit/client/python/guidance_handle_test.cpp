// What a Guidance of Python learns from the queries that are planned with it.

#include "client/python/guidance_handle.hpp"

#include <gtest/gtest.h>

namespace kinship::python::guidance_handle_test {
namespace {

guided::PlannedProblem planned(SamplingMode mode, std::uint64_t checks, double time_s) {
  guided::PlannedProblem planned;
  planned.outcome = Outcome::Solved;
  planned.result.sampling_mode = mode;
  planned.result.collision_checks = checks;
  planned.result.processor_time_s = time_s;
  return planned;
}

/// The part of guided queries after guided ones that took few checks and much time.
double part_with(double guided_time_s, double control_time_s) {
  guided::GuidanceAnswer answer;
  answer.sampling.emplace(Advice{}, guided::SamplingModeOptions{.guided_fraction = 1});
  GuidanceHandle handle({}, std::move(answer));
  for (int times = 0; times < 40; ++times) {
    handle.add(planned(SamplingMode::Guided, 100, guided_time_s));
    handle.add(planned(SamplingMode::Control, 1000, control_time_s));
  }
  return handle.guided_part();
}

TEST(GuidanceHandle, ComparesTheTimesOfQueries) {
  EXPECT_LT(part_with(0.1, 0.01), 0.1);
  EXPECT_GT(part_with(0.01, 0.1), 0.9);
}

TEST(GuidanceHandle, ComparesChecksWhereNoTimeIsKnown) { EXPECT_GT(part_with(0, 0), 0.9); }

}  // namespace
}  // namespace kinship::python::guidance_handle_test
