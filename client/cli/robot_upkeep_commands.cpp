#include "client/cli/robot_upkeep_commands.hpp"

#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "client/cli/cell_text.hpp"
#include "client/link/robot_names.hpp"
#include "client/link/robot_upkeep.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/types/names.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kRename = "robots rename", kRemove = "robots remove";

int count_distributions(link::Client& server, const std::string& robot, std::ostream& err,
                        std::size_t& count) {
  count = 0;
  ListOptions options;
  options.robot = robot;
  return for_each_row(server, AdminVerb::ListDistributions, options, kRemove, err,
                      [&](const std::string&) {
                        ++count;
                        return true;
                      });
}

int say_what_would_happen(link::Client& server, const RobotSummary& robot, std::ostream& err) {
  std::size_t distributions = 0;
  if (const int code = count_distributions(server, robot.robot.hex(), err, distributions);
      code != kDone)
    return code;
  err << kRemove << ": this would retire " << count_text(robot.paths, "path") << " of '"
      << robot.label << "' (" << robot.robot.short_hex()
      << "): out of every fit, not to be undone. " << count_text(robot.attempts, "attempt")
      << " would stay on record, " << count_text(distributions, "distribution")
      << " for it would go, those of other robots that used its paths be fitted anew. To do it: "
         "kinship robots remove "
      << robot.label << " --yes; to free the label alone: kinship robots rename " << robot.label
      << " NEW\n";
  return kWrongUsage;
}

void print_removal(const RobotRemoval& removal, std::ostream& out) {
  out << '\'' << removal.label << "' (" << removal.robot.short_hex() << ") ";
  if (removal.is_deleted)
    out << "deleted: it had no attempts";
  else
    out << "removed: " << count_text(removal.paths, "path") << " retired, "
        << count_text(removal.attempts, "attempt") << " stay on record";
  out << "; " << count_text(removal.distributions, "distribution")
      << " for it gone; the label is free\n"
      << "If its clients report again they register it again; while another robot has the label "
         "their reports wait with them\n";
}

}  // namespace

int rename_robot(link::Client& server, const std::string& robot, const std::string& label,
                 bool json, std::ostream& out, std::ostream& err) {
  if (const auto error = check_label(label))
    return refuse(kRename, *error, err);
  const auto summary = link::rename_robot(server, robot, label);
  if (!summary)
    return refuse(kRename, summary.error(), err);
  if (json)
    out << json::to_json(*summary) << '\n';
  else
    out << "robot " << summary->robot.short_hex() << " is called '" << summary->label << "' now\n";
  return kDone;
}

int remove_robot(link::Client& server, const std::string& robot, bool confirmed, bool json,
                 std::ostream& out, std::ostream& err) {
  const auto summary = link::find_robot(server, robot);
  if (!summary)
    return refuse(kRemove, summary.error(), err);
  if (!confirmed && summary->attempts > 0)
    return say_what_would_happen(server, *summary, err);
  // By its digest: the label may be another robot's by now.
  const auto removal = link::remove_robot(server, summary->robot.hex());
  if (!removal)
    return refuse(kRemove, removal.error(), err);
  if (json)
    out << json::to_json(*removal) << '\n';
  else
    print_removal(*removal, out);
  return kDone;
}

}  // namespace kinship::cli
