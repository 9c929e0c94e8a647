#include "client/planning/arm_choice.hpp"

#include <bit>
#include <stdexcept>
#include <string>

#include "proto/types/pose.hpp"

namespace kinship::planning {
namespace {

/// A bijection of 64 bits in which every bit of the input reaches every bit of the output.
/// Source: Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators (2014), fig. 16.
std::uint64_t mixed(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return bits ^ (bits >> 31U);
}

/// Numbers one after another become one number.
class Fingerprint {
 public:
  void add(std::uint64_t bits) { state_ = mixed(state_ + kGolden) ^ mixed(bits); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  std::uint64_t value() const { return mixed(state_ + kGolden); }

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15U;  // 2^64 / golden ratio, odd
  std::uint64_t state_ = 0;
};

/// From 0 to below 1, a multiple of 2^-53.
double unit_interval(std::uint64_t bits) {
  constexpr double kStep = 0x1p-53;
  return static_cast<double>(bits >> 11U) * kStep;
}

void require_part(const char* what, double value) {
  if (!(value >= 0 && value <= 1))
    throw std::invalid_argument(std::string("plan_arms: ") + what + " is " + std::to_string(value) +
                                ", must be 0 to 1");
}

std::uint64_t attempts_of(const std::optional<ArmEvidence>& evidence) {
  return evidence ? evidence->attempts : 0;
}

}  // namespace

ArmPlan plan_arms(const Advice& advice, const ArmOptions& options) {
  const double share = options.share.value_or(advice.recommended_share);
  require_part("share", share);
  require_part("control share", options.control_share.value_or(0));
  const bool is_guided = options.share ? share > 0 : share >= kLeastShare;
  if (!is_guided && options.share)
    return {0, false, 0};
  const std::uint64_t known = attempts_of(is_guided ? advice.control : advice.guided);
  const double part = known < kEarlyTrials ? kEarlyTrialPart : kLateTrialPart;
  return {is_guided ? share : kTrialShare, is_guided, options.control_share.value_or(part)};
}

ArmChoice choose_arm(const ArmPlan& plan, std::uint64_t seed) {
  const bool is_trial = unit_interval(mixed(seed)) < plan.trial_part;
  if (is_trial == plan.is_guided)
    return {Arm::Control, 0};
  return {Arm::Guided, plan.share};
}

std::uint64_t arm_seed(const Problem& problem) {
  Fingerprint fingerprint;
  fingerprint.add(problem.seed);
  fingerprint.add(problem.name.size());
  for (const char c : problem.name)
    fingerprint.add(std::uint64_t{static_cast<unsigned char>(c)});
  for (const double q : problem.start)
    fingerprint.add(q);
  for (const double q : problem.goal_configurations.reshaped())
    fingerprint.add(q);
  if (problem.T_task_goal)
    for (const double number : to_pose_array(*problem.T_task_goal))
      fingerprint.add(number);
  return fingerprint.value();
}

}  // namespace kinship::planning
