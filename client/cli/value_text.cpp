#include "client/cli/value_text.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/duration_text.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

using tables::Table;

/// A few digits, without zeros at the end.
std::string bound_text(double value) {
  constexpr int kDigits = 4;
  std::ostringstream text;
  text.precision(kDigits);
  text << value;
  return text.str();
}

std::string configuration_text(const Eigen::VectorXd& q) {
  constexpr int kDigits = 4;
  std::string text;
  for (const double value : q)
    text += (text.empty() ? "" : " ") + number_text(value, kDigits);
  return text;
}

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

/// How many times the cost of a guide is spent without one; "-" if unknown.
std::string gain_text(const std::vector<GuideCost>& costs, const GuideCost& cost,
                      double GuideCost::*mean) {
  constexpr int kDigits = 2;
  const auto none = std::ranges::find(costs, Guide::None, &GuideCost::guide);
  if (none == costs.end() || cost.*mean <= 0 || (*none).*mean <= 0)
    return "-";
  return number_text((*none).*mean / cost.*mean, kDigits);
}

}  // namespace

std::string means_text(const PathMeans& means) {
  return duration_text(means.time_s) + ", " + number_text(means.length, 2) + " long, hand " +
         number_text(means.hand_length_m, 2) + " m, clearance " +
         number_text(means.least_clearance_m, 3) + " m (mean of " + std::to_string(means.attempts) +
         ")";
}

std::string worth_text(const Worth& worth) {
  constexpr int kDigits = 2;
  return (worth.by_time ? number_text(*worth.by_time, kDigits) + " by time, " : std::string()) +
         number_text(worth.by_checks, kDigits) + " by checks (best without experience " +
         std::string(to_text(worth.without)) + ", with it " + std::string(to_text(worth.with)) +
         ")";
}

std::string axes_text(const TaskAxes& axes) {
  if (axes.all())
    return "all";
  std::string text;
  for (std::size_t i = 0; i < kTaskAxisNames.size(); ++i)
    if (axes.matters[i])
      text += (text.empty() ? "" : " ") + std::string(kTaskAxisNames[i]);
  return text;
}

void print_transfer(const RobotDescription& description, std::ostream& out) {
  constexpr int kDigits = 4;
  out << "transfer    " << pose_text(description.T_tip_transfer) << " in " << description.tip_link
      << '\n'
      << "axes        " << axes_text(description.task_axes) << '\n';
  if (description.held_joints.empty())
    return;
  std::string held;
  for (const auto& [joint, value] : description.held_joints)
    held += (held.empty() ? "" : ", ") + joint + " = " + number_text(value, kDigits);
  out << "held        " << held << '\n';
}

std::string region_text(const TaskSpaceRegion& region) {
  constexpr Eigen::Index kFirstAngle = 3;
  std::string bounds;
  for (Eigen::Index i = 0; i < region.bounds.cols(); ++i) {
    const double lower = region.bounds(0, i), upper = region.bounds(1, i);
    if (!std::isfinite(lower) && !std::isfinite(upper))
      continue;
    bounds += (bounds.empty() ? ": " : ", ") + std::string(displacement_name(i)) + " " +
              bound_text(lower) + ".." + bound_text(upper) + (i < kFirstAngle ? " m" : " rad");
  }
  return "stays within a task space region" + (bounds.empty() ? " without bounds" : bounds);
}

void print_scene(const RecordedScene& scene, std::ostream& out) {
  out << "scene       " << scene.objects.size() << " objects, " << scene.held.size() << " held\n";
  if (scene.constraint)
    out << "constraint  " << region_text(*scene.constraint) << '\n';
}

void print_search(const SearchRecord& search, std::ostream& out) {
  if (!search.reason.empty())
    out << "why         " << search.reason << '\n';
  const char* heading = "in the way  ";
  for (const auto& [blocker, goals] : blockers_by_goals(search)) {
    out << heading << "'" << blocker.first << "' touches '" << blocker.second << "' in ";
    if (goals > 0)
      out << goals << " of " << count_text(static_cast<std::uint64_t>(search.goals.cols()), "goal")
          << (blocker.count > 0 ? " and " : "");
    if (blocker.count > 0)
      out << count_text(blocker.count, "refused configuration");
    out << '\n';
    heading = "            ";
  }
  if (search.goals.cols() > 0)
    out << "goals       " << count_text(static_cast<std::uint64_t>(search.goals.cols()), "goal")
        << '\n';
  for (const GoalContact& contact : search.goal_contacts)
    out << "            at goal " << contact.goal + 1 << " '" << contact.first << "' touches '"
        << contact.second << "'\n";
  if (search.last_free.size() > 0)
    out << "last free   " << configuration_text(search.last_free) << '\n';
  for (const SearchTree& tree : search.trees)
    out << "tree        "
        << count_text(static_cast<std::uint64_t>(tree.configurations.cols()), "configuration")
        << '\n';
  out << "seed        " << search.seed << '\n';
}

void print_rehearsal(const std::optional<Rehearsal>& rehearsal, std::ostream& out) {
  if (!rehearsal) {
    out << "not rehearsed yet: a fetch that asks for stored ways begins it\n";
    return;
  }
  out << sentence(*rehearsal) << '\n';
  if (rehearsal->costs.empty())
    return;
  Table table({"GUIDE", "PLANS", "SOLVED", "MEAN TIME", "UNIFORM / GUIDED", "MEAN CHECKS",
               "UNIFORM / GUIDED", ""});
  for (const GuideCost& cost : rehearsal->costs)
    table.add_row({std::string(to_text(cost.guide)), std::to_string(cost.plans),
                   std::to_string(cost.solved),
                   cost.mean_time_s > 0 ? duration_text(cost.mean_time_s) : "-",
                   gain_text(rehearsal->costs, cost, &GuideCost::mean_time_s),
                   number_text(cost.mean_checks, 0),
                   gain_text(rehearsal->costs, cost, &GuideCost::mean_checks),
                   cost.guide == rehearsal->guide ? "chosen" : ""});
  table.print(out);
  if (const auto value = worth(*rehearsal))
    out << "worth of the experience: " << worth_text(*value) << '\n';
}

}  // namespace kinship::cli
