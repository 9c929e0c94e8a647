#include "client/cli/rehearsal_text.hpp"

#include <algorithm>
#include <ostream>
#include <string>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

using tables::Table;

std::string sentence(const Rehearsal& rehearsal) {
  if (rehearsal.queries == 0)
    return rehearsal.message.empty() ? "not rehearsed: there is no recorded query"
                                     : rehearsal.message;
  std::string text = rehearsal.is_complete ? "rehearsed on " : "being rehearsed on ";
  text += std::to_string(rehearsal.queries) +
          (rehearsal.queries == 1 ? " recorded query" : " recorded queries");
  if (rehearsal.left_out > 0)
    text += " (" + std::to_string(rehearsal.left_out) +
            " left out: the robot cannot take their start or goal where it stands)";
  text += ", " + number_text(rehearsal.processor_time_s, 1) + " s of processor time";
  return text + (rehearsal.message.empty() ? "" : ": " + rehearsal.message);
}

/// How many times the checks of a guide are needed without one; "-" if unknown.
std::string gain_text(const std::vector<GuideCost>& costs, const GuideCost& cost) {
  constexpr int kDigits = 2;
  const auto none = std::ranges::find(costs, Guide::None, &GuideCost::guide);
  if (none == costs.end() || cost.mean_checks <= 0)
    return "-";
  return number_text(none->mean_checks / cost.mean_checks, kDigits);
}

}  // namespace

void print_rehearsal(const std::optional<Rehearsal>& rehearsal, std::ostream& out) {
  if (!rehearsal) {
    out << "not rehearsed yet: a fetch that asks for stored ways begins it\n";
    return;
  }
  out << sentence(*rehearsal) << '\n';
  if (rehearsal->costs.empty())
    return;
  Table table({"GUIDE", "PLANS", "SOLVED", "MEAN CHECKS", "MEDIAN CHECKS", "UNIFORM / GUIDED", ""});
  for (const GuideCost& cost : rehearsal->costs)
    table.add_row({std::string(to_text(cost.guide)), std::to_string(cost.plans),
                   std::to_string(cost.solved), number_text(cost.mean_checks, 0),
                   number_text(cost.median_checks, 0), gain_text(rehearsal->costs, cost),
                   cost.guide == rehearsal->guide ? "chosen" : ""});
  table.print(out);
}

}  // namespace kinship::cli
