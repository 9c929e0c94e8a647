#include "client/cli/compare_command.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <utility>

#include "client/cli/cell_text.hpp"
#include "client/cli/plot_commands.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/reported_placement.hpp"
#include "client/link/robot_names.hpp"
#include "pages/plots/plot_pages.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/task_experience.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {
namespace {

using link::ReportedPlacement;
using tables::Column;
using tables::Fit;
using tables::Table;

constexpr std::string_view kCompare = "robots compare";

/// Placements of robots from the command line, by label.
using Placements = std::map<std::string, Eigen::Isometry3d>;

struct Target {
  Digest robot;
  std::string label;
  ReportedPlacement placement;
};

Result<Placements> parse_placements(const std::vector<std::string>& texts) {
  Placements placements;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return Error{ErrorCode::InvalidInput, "--placement: '" + text +
                                                "' is not LABEL=x y z qx qy qz qw, as in \"ur10e=0 "
                                                "0 0.6 0 0 0 1\""};
    const auto pose = models::parse_pose(text.substr(equals + 1));
    if (!pose)
      return Error{pose.error().code, "--placement: " + pose.error().message};
    placements.insert_or_assign(text.substr(0, equals), *pose);
  }
  return placements;
}

/// Where a robot stands, as it last reported the task; unknown if it has not.
ReportedPlacement reported(link::Client& server, const std::string& task, const std::string& robot,
                           std::ostream& err) {
  const auto placement = link::reported_placement(server, task, robot);
  if (!placement)
    refuse(kCompare, placement.error(), err);
  return placement ? *placement : ReportedPlacement();
}

/// The robots that are asked about. Empty with an exit code in `code` if something is wrong.
std::vector<Target> find_targets(link::Client& server, const CompareOptions& options,
                                 const Placements& placements, std::ostream& err, int& code) {
  std::vector<Target> targets;
  const auto add = [&](const Digest& robot, const std::string& label) {
    const auto told = placements.find(label);
    targets.push_back({robot, label,
                       told != placements.end() ? ReportedPlacement{true, told->second}
                                                : reported(server, options.task, label, err)});
  };
  std::vector<std::pair<Digest, std::string>> robots;
  if (options.targets.empty()) {
    const auto error =
        link::for_each_row(server, {.verb = AdminVerb::ListRobots}, [&](const std::string& row) {
          if (const auto robot = json::row_from_json<RobotSummary>(row))
            robots.emplace_back(robot->robot, robot->label);
          return true;
        });
    code = error ? refuse(kCompare, *error, err) : kDone;
  }
  for (const std::string& name : options.targets) {
    const auto robot = link::find_robot(server, name);
    if (!robot) {
      code = refuse(kCompare, robot.error(), err);
      return {};
    }
    robots.emplace_back(robot->robot, robot->label);
  }
  for (const auto& [robot, label] : robots)
    add(robot, label);
  for (const auto& [label, pose] : placements)
    if (std::ranges::find(targets, label, &Target::label) == targets.end()) {
      err << kCompare << ": --placement names '" << label << "', which is not among the robots\n";
      code = kWrongUsage;
      return {};
    }
  return targets;
}

/// Has the server rehearse one pair.
Transferability compare_pair(link::Client& server, const CompareOptions& options,
                             const Target& target, const TaskRobotSummary& source) {
  Transferability pair{target.robot, source.robot, target.label, source.label, {}, {}};
  if (!target.placement.is_known) {
    pair.message = "where its base stands is not known: --placement \"" + target.label + "=...\"";
    return pair;
  }
  FetchRequest request;
  request.task = options.task;
  request.robot = target.robot;
  request.T_task_base = target.placement.T_task_base;
  request.selection.sources = {source.robot};
  request.deadline = options.wait;
  request.experience_bytes = kDefaultExperienceBytes;
  request.rehearsed = true;
  auto reply = server.fetch(request);
  if (!reply) {
    pair.message = reply.error().message;
    return pair;
  }
  pair.message = reply->message;
  pair.rehearsal = std::move(reply).value().rehearsal;
  if (pair.rehearsal && !pair.rehearsal->message.empty())
    pair.message = pair.rehearsal->message;
  if (!pair.rehearsal && pair.message.empty())
    pair.message = "not rehearsed within the time (--wait)";
  return pair;
}

/// By time and by checks, the queries that a target could not take, and the messages of pairs.
void print_remarks(const std::vector<Transferability>& pairs, std::ostream& out) {
  for (const Transferability& pair : pairs) {
    const std::string names = pair.target_label + " from " + pair.source_label + ": ";
    if (const auto value = pair.rehearsal ? worth(*pair.rehearsal) : std::nullopt)
      out << names << worth_text(*value) << '\n';
    if (!pair.message.empty())
      out << names << pair.message << '\n';
    if (pair.rehearsal && pair.rehearsal->left_out > 0)
      out << names << pair.rehearsal->left_out << " of "
          << pair.rehearsal->queries + pair.rehearsal->left_out
          << " recorded queries left out: it cannot take their start or goal where it stands\n";
  }
}

void print_comparison(const std::string& task, const std::vector<Transferability>& pairs,
                      std::ostream& out) {
  out << "Processor time with the best guide that needs no experience (none, retreat) /\n"
         "with the best that uses it, when TARGET (row) plans with the experience of\n"
         "SOURCE (column); above 1 it pays, * the best of a row. Predicted by replay of\n"
         "SOURCE's recorded queries of '"
      << task
      << "', leave-one-out: the path that\n"
         "originally solved a query is excluded, also on the diagonal.\n\n";
  print_worths(pairs, out);
  out << '\n';
  print_remarks(pairs, out);
}

}  // namespace

void print_worths(const std::vector<Transferability>& pairs, std::ostream& out) {
  constexpr int kDigits = 2;
  std::vector<Column> headings{"TARGET \\ SOURCE"};
  for (const Transferability& pair : pairs)
    if (pair.target == pairs.front().target)
      headings.emplace_back(pair.source_label, Fit::Cut);
  const std::size_t sources = headings.size() - 1;
  Table table(std::move(headings));
  for (std::size_t row = 0; row < pairs.size(); row += sources) {
    double best = 0;
    for (std::size_t i = row; i < row + sources; ++i)
      if (pairs[i].rehearsal)
        best = std::max(best, worth(*pairs[i].rehearsal).value_or(Worth{}).value());
    std::vector<std::string> cells{pairs[row].target_label};
    for (std::size_t i = row; i < row + sources; ++i) {
      const auto value = pairs[i].rehearsal ? worth(*pairs[i].rehearsal) : std::nullopt;
      cells.push_back(!value ? "-"
                             : number_text(value->value(), kDigits) +
                                   (value->value() == best ? "*" : " "));
    }
    table.add_row(std::move(cells));
  }
  table.print(out);
}

int compare_robots(link::Client& server, const CompareOptions& options, std::ostream& out,
                   std::ostream& err) {
  const auto placements = parse_placements(options.placements);
  if (!placements)
    return refuse(kCompare, placements.error(), err);
  if (options.json && options.output == "-")
    return refuse(kCompare,
                  {ErrorCode::InvalidInput, "--json and --output - are both for standard output"},
                  err);
  std::optional<PageFile> page;  // refuses before the server has worked for it
  if (!options.output.empty())
    page.emplace(options.output, out);
  const auto task =
      link::row_of<TaskSummary>(server, {.verb = AdminVerb::ShowTask, .argument = options.task});
  if (!task)
    return refuse(kCompare, task.error(), err);
  std::vector<TaskRobotSummary> sources;
  std::ranges::copy_if(task->robots, std::back_inserter(sources),
                       [](const TaskRobotSummary& robot) { return robot.paths > 0; });
  if (sources.empty()) {
    err << kCompare << ": no robot has paths of task '" << options.task << "'\n";
    return kNotFound;
  }
  int code = kDone;
  const auto targets = find_targets(server, options, *placements, err, code);
  if (code != kDone)
    return code;

  std::vector<Transferability> pairs;
  StatusLine progress(err, options.progress);
  for (const Target& target : targets)
    for (const TaskRobotSummary& source : sources) {
      progress.show("rehearsing " + std::to_string(pairs.size() + 1) + " of " +
                    std::to_string(targets.size() * sources.size()) + ": " + target.label +
                    " with the experience of " + source.label);
      pairs.push_back(compare_pair(server, options, target, source));
    }
  progress.clear();
  if (page) {
    plots::write_page(options.task, pairs, page->stream());
    page->keep(err);
  }
  if (options.json)
    out << json::to_json(options.task, pairs) << '\n';
  else if (options.output != "-")
    print_comparison(options.task, pairs, out);
  const bool all_told = std::ranges::all_of(
      pairs, [](const Transferability& pair) { return pair.rehearsal.has_value(); });
  return all_told ? kDone : kFailed;
}

}  // namespace kinship::cli
