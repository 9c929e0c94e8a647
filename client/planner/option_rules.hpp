#pragma once

#include <iosfwd>
#include <string>

#include "client/arguments/selection_options.hpp"
#include "client/planner/plan_options.hpp"

namespace CLI {  // NOLINT: theirs
class App;
}  // namespace CLI

namespace kinship::planner {

/// Options as the command line has them, to be looked at once all are known.
struct RawOptions {
  std::string planner;
  std::string guidance;
  std::string report = "no";
  std::string record_scenes = "yes";
  double timeout_s = 5;
  double wait_s = 30;
  double share = 0;
  double control_share = 0;
  arguments::SelectionArguments selection;
};

/// Puts into `options` what depends on several options.
/// \param app    parsed.
/// \param notes  for people: options that have no effect beside the others.
/// \throws CLI::ValidationError for options that do not go together.
void complete(const CLI::App& app, const RawOptions& raw, PlanOptions& options,
              std::ostream& notes);

}  // namespace kinship::planner
