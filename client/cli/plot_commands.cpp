#include "client/cli/plot_commands.hpp"

#include <ostream>
#include <sstream>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/plot_look_up.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "pages/plots/plot_pages.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/types/failure.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kPlotDistribution = "distributions plot";
constexpr std::string_view kPlotPath = "paths plot";
constexpr std::string_view kPlotAttempt = "attempts plot";
constexpr std::string_view kPlotRobot = "robots plot";
constexpr std::string_view kPlotTask = "tasks plot";

/// The distribution of a query, by its id or by the rest of the query. Empty with an exit code in
/// `code` if there is none.
std::optional<Distribution> find_distribution(link::Client& server, const DistributionQuery& query,
                                              bool shows_progress, std::ostream& err, int& code) {
  if (query.id.empty()) {
    StatusLine progress(err, shows_progress);
    progress.show("having it made, if need be ...");
    std::ostringstream trouble;
    auto distribution = fetch_query(server, query, kPlotDistribution, true, trouble, code);
    progress.clear();
    err << trouble.str();
    return distribution;
  }
  const auto row =
      link::first_row_of(server, {.verb = AdminVerb::ShowDistribution, .argument = query.id});
  if (row)
    return json::distribution_from_json(*row).value_or_throw();
  code = refuse(kPlotDistribution, row.error(), err);
  return std::nullopt;
}

/// The contents of a robot's meshes; none of a server that knows of none.
std::vector<StoredMesh> read_meshes(link::Client& server, const std::string& name) {
  std::vector<StoredMesh> meshes;
  const AdminRequest request{.verb = AdminVerb::ListMeshes, .argument = name};
  static_cast<void>(link::for_each_row(server, request, [&](const std::string& row) {
    meshes.push_back(json::row_from_json<StoredMesh>(row).value_or_throw());
    return true;
  }));
  return meshes;
}

/// The rows of one task: the client that asks for them, and the stream for its messages.
struct TaskRows {
  link::Client& server;
  const std::string& task;
  bool shows_progress;
  std::ostream& err;
};

/// All rows of a listing. \throws Failure for a row that cannot be read.
template <typename Parse, typename Row>
int read_rows(const TaskRows& of, AdminVerb verb, Parse parse, std::vector<Row>& rows) {
  constexpr std::size_t kStep = 1000;  // rows between two signs of progress
  StatusLine progress(of.err, of.shows_progress);
  const auto error =
      link::for_each_row(of.server, {.verb = verb, .task = of.task}, [&](const std::string& row) {
        rows.push_back(parse(row).value_or_throw());
        if (rows.size() % kStep == 0)
          progress.show(count_text(rows.size(), "row"));
        return true;
      });
  return error ? refuse(kPlotTask, *error, of.err) : kDone;
}

}  // namespace

int plot_distribution(link::Client& server, const DistributionQuery& query,
                      const PlotOptions& options, std::ostream& out, std::ostream& err) {
  PageFile page(options.output, out);  // refuses before the server has worked for it
  int code = kDone;
  auto distribution = find_distribution(server, query, options.progress, err, code);
  if (code != kDone)
    return code;
  try {
    StatusLine progress(err, options.progress);
    progress.show("searching the poses that its transfer lost ...");
    const plots::LookUp look_up = look_up_of(server);
    const auto figure = plots::distribution_figure(*std::move(distribution), look_up);
    progress.clear();
    plots::write_page(figure, page.stream());
  } catch (const Failure& failure) {
    return refuse(kPlotDistribution, failure.error(), err);
  }
  page.keep(err);
  return kDone;
}

int plot_task(link::Client& server, const std::string& task, const PlotOptions& options,
              std::ostream& out, std::ostream& err) {
  PageFile page(options.output, out);
  std::vector<AttemptSummary> attempts;
  std::vector<DistributionSummary> distributions;
  const TaskRows of{server, task, options.progress, err};
  int code = read_rows(of, AdminVerb::ListAttempts, json::row_from_json<AttemptSummary>, attempts);
  if (code == kDone)
    code = read_rows(of, AdminVerb::ListDistributions, json::row_from_json<DistributionSummary>,
                     distributions);
  if (code != kDone)
    return code;
  if (attempts.empty())
    return refuse(kPlotTask,
                  {ErrorCode::NotFound, "nothing to plot: no attempt of task '" + task + "'"}, err);
  const auto summary =
      link::row_of<TaskSummary>(server, {.verb = AdminVerb::ShowTask, .argument = task});
  if (!summary)
    return refuse(kPlotTask, summary.error(), err);
  StatusLine progress(err, options.progress);
  progress.show("reading its paths ...");
  const plots::LookUp look_up = look_up_of(server);
  const plots::TaskFigure figure{plots::history_of(task, std::move(attempts), distributions),
                                 plots::task_paths(*summary, look_up)};
  progress.clear();
  plots::write_page(figure, page.stream());
  page.keep(err);
  return kDone;
}

int plot_robot(link::Client& server, const std::string& name, const PlotOptions& options,
               std::ostream& out, std::ostream& err) {
  PageFile page(options.output, out);
  const auto robot = find_known_robot(server, name);
  if (!robot)
    return refuse(kPlotRobot, robot.error(), err);
  plots::write_page(
      plots::robot_figure(robot->summary, robot->description, read_meshes(server, name)),
      page.stream());
  page.keep(err);
  return kDone;
}

namespace {

int plot_report(link::Client& server, const std::string& id, std::string_view command,
                const PlotOptions& options, std::ostream& out, std::ostream& err) {
  PageFile page(options.output, out);
  const auto row = link::first_row_of(server, {.verb = AdminVerb::ShowPath, .argument = id});
  if (!row)
    return refuse(command, row.error(), err);
  Attempt attempt = json::stored_attempt_from_json(*row).value_or_throw().attempt;
  if (command == kPlotPath && !attempt.path)
    return refuse(
        command,
        {ErrorCode::NotFound, "nothing to plot: report " + id + " has no path" +
                                  (attempt.record.outcome == Outcome::Solved
                                       ? " any more"
                                       : "; kinship attempts plot shows what was in the way")},
        err);
  const auto robot = find_known_robot(server, attempt.robot.hex());
  if (!robot)
    return refuse(command, robot.error(), err);
  plots::write_page(plots::attempt_figure(std::move(attempt), robot->description),
                    std::string(command), page.stream());
  page.keep(err);
  return kDone;
}

}  // namespace

int plot_path(link::Client& server, const std::string& id, const PlotOptions& options,
              std::ostream& out, std::ostream& err) {
  return plot_report(server, id, kPlotPath, options, out, err);
}

int plot_attempt(link::Client& server, const std::string& id, const PlotOptions& options,
                 std::ostream& out, std::ostream& err) {
  return plot_report(server, id, kPlotAttempt, options, out, err);
}

PageFile::PageFile(const std::filesystem::path& file, std::ostream& otherwise)
    : file_(file == "-" ? std::filesystem::path() : file), output_(file_, otherwise) {}

void PageFile::keep(std::ostream& err) {
  output_.keep();
  if (!file_.empty())
    err << "page in '" << file_.string() << "'\n";
}

}  // namespace kinship::cli
