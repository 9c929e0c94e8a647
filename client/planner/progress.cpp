#include "client/planner/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <numeric>
#include <ostream>
#include <string>

#include "proto/types/duration_text.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::planner {
namespace {

constexpr std::size_t kLines = 10;  // where the output is not a terminal

std::string with_digits(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string guidance_text(const ProblemResult& result) {
  constexpr int kShareDigits = 2;
  if (result.guidance_reason.empty() && result.distribution_id)
    return "guided by " + result.distribution_id->short_hex() + " revision " +
           std::to_string(result.distribution_revision) + ", share " +
           with_digits(result.share, kShareDigits);
  if (result.guidance_reason.empty() && result.guide != Guide::None)
    return "guided by " + std::string(to_text(result.guide)) + ", share " +
           with_digits(result.share, kShareDigits);
  return result.guidance_reason.empty() ? "uniform" : "uniform: " + result.guidance_reason;
}

/// "1.20 m, median 1.15 m"
std::string mean_text(std::vector<double> values, double scale, int digits,
                      const std::string& unit) {
  const auto text = [&](double value) { return with_digits(scale * value, digits) + unit; };
  std::ranges::sort(values);
  const std::size_t count = values.size();
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return text(sum / static_cast<double>(count)) + ", median " +
         text((values[(count - 1) / 2] + values[count / 2]) / 2);
}

}  // namespace

void Progress::add(const ProblemResult& result, bool attempted) {
  const std::size_t lines_before = done_ * kLines / total_;
  ++done_;
  attempted_ += attempted ? 1 : 0;
  unplanned_.add(result);
  if (!result.not_planned) {
    solved_ += result.solved ? 1 : 0;
    checks_ += result.collision_checks;
    planning_time_s_ += result.planning_time_s;
    gated_ += result.gate_fired ? 1 : 0;
    ++(result.sampling_mode == SamplingMode::Guided    ? guided_
       : result.sampling_mode == SamplingMode::Control ? control_
                                                       : uniform_);
  }
  if (result.path_length && result.hand_length_m && result.least_clearance_m) {
    Measures& measures = measures_.at(static_cast<std::size_t>(result.sampling_mode));
    measures.lengths.push_back(*result.path_length);
    measures.hands_m.push_back(*result.hand_length_m);
    measures.clearances_m.push_back(*result.least_clearance_m);
  }
  if (!terminal_ && done_ * kLines / total_ == lines_before)
    return;
  const std::string outcome =
      result.solved ? std::to_string(result.collision_checks) + " checks" : result.reason;
  stream_ << (terminal_ ? "\r\033[K" : "") << "planned " << done_ << "/" << total_ << ", solved "
          << solved_ << ", last: " << guided::named_outcome(result, outcome)
          << (terminal_ ? "" : "\n") << std::flush;
}

void Progress::finish() {
  if (terminal_)
    stream_ << "\r\033[K";
  const std::size_t planned = done_ - unplanned_.size();
  stream_ << "planned " << planned << " of " << total_ << " problems, " << solved_ << " solved";
  if (planned > 0) {
    const auto count = static_cast<double>(planned);
    stream_ << "; " << guided_ << " guided"
            << (gated_ > 0 ? " (" + std::to_string(gated_) + " uniform by the gate)" : "") << ", "
            << control_ << " control, " << uniform_ << " uniform; on average "
            << with_digits(static_cast<double>(checks_) / count, 0) << " checks and "
            << duration_text(planning_time_s_ / count);
  }
  if (unplanned_.size() > 0) {
    stream_ << "; " << unplanned_.size() << " could not be planned (" << unplanned_.reasons()
            << "):\n";
    unplanned_.write_first(stream_);
  } else {
    stream_ << '\n';
  }
  write_measures();
  stream_ << std::flush;
}

void Progress::write_measures() const {
  for (std::size_t mode = 0; mode < measures_.size(); ++mode)
    if (const Measures& of = measures_[mode]; !of.lengths.empty())
      stream_ << "paths " << to_text(static_cast<SamplingMode>(mode)) << ": length "
              << mean_text(of.lengths, 1, 2, "") << "; hand's " << mean_text(of.hands_m, 1, 2, " m")
              << "; least clearance " << mean_text(of.clearances_m, 1e3, 1, " mm") << '\n';
}

std::string result_text(const ProblemResult& result) {
  if (result.not_planned)
    return guided::named_outcome(result, result.reason);
  std::string text = result.name + ": ";
  text += result.solved && result.waypoints
              ? "solved, " + std::to_string(result.waypoints->cols()) + " waypoints"
              : "not solved, " + result.reason;
  text += "; " + result.planner + ", " + std::to_string(result.collision_checks) + " checks in " +
          duration_text(result.planning_time_s) + " of " + with_digits(result.time_limit_s, 0) +
          " s";
  return text + "; " + guidance_text(result);
}

}  // namespace kinship::planner
