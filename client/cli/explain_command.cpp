#include "client/cli/explain_command.hpp"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "client/cli/admin_rows.hpp"
#include "client/cli/fetch_command.hpp"
#include "client/cli/table.hpp"
#include "proto/json/admin_rows_json.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kExplain = "distributions explain";

/// The generation of a robot's experience that the fit read; empty if it read none.
std::string fitted_generation(const Distribution& distribution, const Digest& robot) {
  const auto source =
      std::find_if(distribution.sources.begin(), distribution.sources.end(),
                   [&](const Source& candidate) { return candidate.robot == robot; });
  return source == distribution.sources.end() ? "-" : std::to_string(source->generation);
}

void print_arm(const char* name, const std::optional<ArmEvidence>& arm, std::ostream& out) {
  out << name;
  if (!arm) {
    out << "no attempts\n";
    return;
  }
  out << arm->attempts << " attempts, " << arm->solved << " solved";
  if (arm->solved > 0)
    out << ", " << number_text(arm->checks_per_solution, 0) << " collision checks per solution";
  out << '\n';
}

void print_explanation(const Explanation& explanation, std::ostream& out) {
  print_distribution(explanation.distribution, out);
  out << '\n';
  print_arm("guided      ", explanation.distribution.advice.guided, out);
  print_arm("control     ", explanation.distribution.advice.control, out);
  out << "experience  " << (explanation.behind ? "has grown since the fit" : "is that of the fit")
      << (explanation.next_fit.empty() ? "" : "; next fit: ") << explanation.next_fit << "\n\n";
  Table table({"EXPERIENCE NOW", "ROBOT", "PATHS", "GENERATION", "FITTED"});
  for (const Explanation::Now& now : explanation.experience)
    table.add_row({now.label, now.robot.short_hex(), std::to_string(now.paths),
                   std::to_string(now.generation),
                   fitted_generation(explanation.distribution, now.robot)});
  table.print(out);
}

}  // namespace

int explain_distribution(link::Client& server, const DistributionWish& wish, bool json,
                         std::ostream& out, std::ostream& err) {
  int code = kDone;
  const std::string id = id_of_wish(server, wish, kExplain, true, err, code);
  if (code != kDone)
    return code;
  const auto rows = show_rows(server, AdminVerb::ExplainDistribution, id, kExplain, err, code);
  if (code != kDone)
    return code;
  if (json) {
    out << rows.front() << '\n';
    return kDone;
  }
  const auto explanation = json::explanation_from_json(rows.front());
  if (!explanation)
    return refuse(kExplain, {ErrorCode::Internal, explanation.error().message}, err);
  print_explanation(*explanation, out);
  return kDone;
}

}  // namespace kinship::cli
