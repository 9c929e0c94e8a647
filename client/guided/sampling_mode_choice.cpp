#include "client/guided/sampling_mode_choice.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

#include "proto/evidence/cost_ratio.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/split_mix.hpp"

namespace kinship::guided {
namespace {

// A comparison of the modes costs about 0.1 ms with all attempts that are known, as much as a plan
// may, so not every attempt is followed by one.
constexpr double kComparison_s = 0.4e-6;  // processor time for each attempt compared
constexpr double kCheck_s = 1e-6;         // for each check where no time is known
constexpr double kMaxPart = 0.005;        // of the time of planning that comparisons take
constexpr std::size_t kMaxParts = 4;      // the evidence never grows by more than a fourth unseen

/// Numbers one after another become one number.
class Fingerprint {
 public:
  void add(std::uint64_t bits) { state_ = split_mixed(state_ + kSplitMixStep) ^ split_mixed(bits); }
  void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
  std::uint64_t value() const { return split_mixed(state_ + kSplitMixStep); }

 private:
  std::uint64_t state_ = 0;
};

void require_part(const char* what, double value) {
  if (!(value >= 0 && value <= 1))
    throw std::invalid_argument(std::string("SamplingModeChooser: ") + what + " is " +
                                std::to_string(value) + ", must be 0 to 1");
}

std::uint64_t attempts_of(const std::optional<ModeEvidence>& evidence) {
  return evidence ? evidence->attempts : 0;
}

}  // namespace

double guided_fraction(const Advice& advice, const SamplingModeOptions& options) {
  const double guided_fraction = options.guided_fraction.value_or(advice.guided_share);
  require_part("share", guided_fraction);
  return guided_fraction;
}

SamplingModeChooser::SamplingModeChooser(const Advice& advice, const SamplingModeOptions& options)
    : options_(options),
      window_(advice.recent),
      guided_(attempts_of(advice.guided)),
      control_(attempts_of(advice.control)) {
  require_part("share", options.guided_fraction.value_or(0));
  require_part("control share", options.control_fraction.value_or(0));
  compare();
}

SamplingMode SamplingModeChooser::choose(std::uint64_t seed) const {
  if (is_uniform())
    return SamplingMode::Uniform;
  // Under Thompson sampling each query draws anew, also a problem that is planned again and again;
  // under a fixed part the same queries are control in every run.
  const std::uint64_t known = is_sampling() ? guided_ + control_ : 0;
  const double drawn = unit_interval(split_mixed(seed + split_mixed(known)));
  return drawn < 1 - guided_part() ? SamplingMode::Control : SamplingMode::Guided;
}

double SamplingModeChooser::guided_part() const {
  if (is_uniform())
    return 0;
  if (options_.control_fraction)
    return 1 - *options_.control_fraction;
  const double floor = control_ < kEarlyControls ? kEarlyControlFloor : kLateControlFloor;
  return std::clamp(guided_is_cheaper_, kGuidedFloor, 1 - floor);
}

void SamplingModeChooser::compare() {
  guided_is_cheaper_ = evidence::compare_costs(window_.recent()).guided_is_cheaper;
  added_ = 0;
  planned_s_ = 0;
}

/// Where guidance is known not to pay, one query in fifty is guided: what the others bring does not
/// change that, so they are cheap.
bool SamplingModeChooser::is_belief_due() const {
  const std::size_t known = window_.recent().size();
  return added_ * kMaxParts >= known ||
         (guided_is_cheaper_ > kGuidedFloor &&
          kMaxPart * planned_s_ >= kComparison_s * static_cast<double>(known));
}

void SamplingModeChooser::add(SamplingMode mode, Outcome outcome, std::uint64_t checks,
                              double time_s) {
  if (mode == SamplingMode::Uniform || outcome == Outcome::Failed)
    return;
  ++(mode == SamplingMode::Guided ? guided_ : control_);
  window_.add(mode, outcome == Outcome::Solved, checks, time_s);
  ++added_;
  planned_s_ += time_s > 0 ? time_s : kCheck_s * static_cast<double>(checks);
  if (is_sampling() && is_belief_due())
    compare();
}

std::uint64_t sampling_mode_seed(const Problem& problem) {
  Fingerprint fingerprint;
  fingerprint.add(problem.seed);
  fingerprint.add(problem.name.size());
  for (const char c : problem.name)
    fingerprint.add(std::uint64_t{static_cast<unsigned char>(c)});
  for (const double q : problem.start)
    fingerprint.add(q);
  for (const double q : problem.goal_configurations.reshaped())
    fingerprint.add(q);
  for (const auto& pose : {problem.T_task_start, problem.T_task_goal})
    if (pose)
      for (const double number : to_pose_array(*pose))
        fingerprint.add(number);
  return fingerprint.value();
}

}  // namespace kinship::guided
