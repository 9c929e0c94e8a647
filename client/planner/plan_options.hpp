#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "client/guided/plan_settings.hpp"
#include "client/guided/sampling_mode_choice.hpp"
#include "client/link/kept_reports.hpp"
#include "proto/types/selection.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::planner {

enum class GuidanceMode {
  Uniform,  ///< no guidance
  Auto,     ///< guided or control, query by query, by the cost of both so far
  Always,   ///< every query that has guidance is guided, without control
  Require   ///< as Auto, and a run without guidance fails
};

/// The command line of kinship-plan.
struct PlanOptions {
  std::filesystem::path problems;  ///< "-": standard input
  models::RobotArguments robot;
  std::string task;
  GuidanceMode guidance = GuidanceMode::Auto;
  std::string profile = "default";
  std::optional<Guide> guide;  ///< missing: the one found by rehearsal, else all
  bool rehearsed = false;      ///< wait for a rehearsal, as for a distribution
  guided::SamplingModeOptions sampling;
  Selection selection;               ///< without its sources
  std::vector<std::string> sources;  ///< labels or digests of its sources; empty: all
  bool report = false;
  bool record_scenes = true;  ///< reports carry their problem's scene
  std::string machine;        ///< empty: the host's name
  guided::PlanSettings settings;
  std::uint64_t seed_offset = 0;   ///< added to each problem's seed
  std::filesystem::path output;    ///< empty: standard output
  std::filesystem::path searches;  ///< the growth of each search; empty: not recorded
  bool json = false;               ///< results as JSON Lines also on a terminal
  std::uint32_t domain = 0;
  std::string server = "127.0.0.1";  ///< host of kinshipd
  std::filesystem::path security;    ///< folder of credentials; empty: none
  std::chrono::milliseconds timeout{5000};
  std::chrono::milliseconds wait{30000};
  std::filesystem::path outbox;                        ///< empty: the client's default
  link::Resend resend = link::Resend::Unacknowledged;  ///< what a store new to the outbox is sent

  /// Whether guidance needs the experience of a server.
  bool needs_experience() const {
    return guidance != GuidanceMode::Uniform && (!guide || kinship::needs_experience(*guide));
  }
};

/// Reports an option without effect beside the others on `err`, or refuses it.
/// \return the options, or the exit code after help (0) or a wrong command line (2, with the error
///         on `err`).
std::variant<PlanOptions, int> parse_plan_options(int argc, const char* const* argv,
                                                  std::ostream& out, std::ostream& err);

}  // namespace kinship::planner
