#include "client/planner/progress.hpp"

#include <cstdio>
#include <ostream>
#include <string>

namespace kinship::planner {
namespace {

constexpr std::size_t kLines = 10;  // where the output is not a terminal

/// "shelf-1-0003: every goal collides"; why a line could not be read begins with its name already.
std::string named(const ProblemResult& result, const std::string& outcome) {
  return outcome.starts_with(result.name + ":") ? outcome : result.name + ": " + outcome;
}

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
  return result.guidance_reason.empty() ? "uniform" : "uniform: " + result.guidance_reason;
}

}  // namespace

void Progress::add(const ProblemResult& result, bool attempted) {
  const std::size_t lines_before = done_ * kLines / total_;
  ++done_;
  if (result.solved)
    ++solved_;
  checks_ += result.collision_checks;
  planning_time_s_ += result.planning_time_s;
  gated_ += attempted && result.gate_fired ? 1 : 0;
  if (attempted)
    ++(result.sampling_mode == SamplingMode::Guided    ? guided_
       : result.sampling_mode == SamplingMode::Control ? control_
                                                       : uniform_);
  if (!terminal_ && done_ * kLines / total_ == lines_before)
    return;
  const std::string outcome =
      result.solved ? std::to_string(result.collision_checks) + " checks" : result.reason;
  stream_ << (terminal_ ? "\r\033[K" : "") << "planned " << done_ << "/" << total_ << ", solved "
          << solved_ << ", last: " << named(result, outcome) << (terminal_ ? "" : "\n")
          << std::flush;
}

void Progress::finish() {
  if (terminal_)
    stream_ << "\r\033[K";
  const std::size_t attempted = this->attempted();
  stream_ << "planned " << attempted << " of " << total_ << " problems, " << solved_ << " solved";
  if (attempted > 0) {
    char text[96];
    std::snprintf(text, sizeof text, "; on average %.0f checks and %.3f s",
                  static_cast<double>(checks_) / static_cast<double>(attempted),
                  planning_time_s_ / static_cast<double>(attempted));
    stream_ << "; " << guided_ << " guided"
            << (gated_ > 0 ? " (" + std::to_string(gated_) + " uniform by the gate)" : "") << ", "
            << control_ << " control, " << uniform_ << " uniform" << text;
  }
  if (done_ > attempted)
    stream_ << "; " << done_ - attempted << " could not be attempted";
  stream_ << std::endl;
}

std::string result_text(const ProblemResult& result) {
  constexpr int kTimeDigits = 3;
  if (result.planner.empty())  // no planner was started
    return named(result, result.reason);
  std::string text = result.name + ": ";
  text += result.solved && result.waypoints
              ? "solved, " + std::to_string(result.waypoints->cols()) + " waypoints"
              : "not solved, " + result.reason;
  text += "; " + result.planner + ", " + std::to_string(result.collision_checks) + " checks in " +
          with_digits(result.planning_time_s, kTimeDigits) + " s of " +
          with_digits(result.time_limit_s, 0) + " s";
  return text + "; " + guidance_text(result);
}

}  // namespace kinship::planner
