#include "client/planner/result_text.hpp"

#include <cstdio>

namespace kinship::planner {
namespace {

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

std::string result_text(const ProblemResult& result) {
  constexpr int kTimeDigits = 3;
  if (result.planner.empty())  // no planner was started
    return result.reason.starts_with(result.name + ":") ? result.reason
                                                        : result.name + ": " + result.reason;
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
