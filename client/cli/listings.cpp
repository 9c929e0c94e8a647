#include "client/cli/listings.hpp"

#include <algorithm>
#include <array>
#include <concepts>
#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <string_view>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/clients_of_name.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/names.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;

std::string text_of(const std::string& text) { return text; }
std::string text_of(const Digest& id) { return id.short_hex(); }
std::string text_of(const Uuid& id) { return id.text(); }
std::string text_of(std::integral auto count) { return std::to_string(count); }
template <typename Enum>
requires std::is_enum_v<Enum> std::string text_of(Enum word) { return std::string(to_text(word)); }

/// A column of a listing: its heading, and the text of a row in it.
template <typename Row>
struct RowColumn {
  /// \param of  a member of the row, or a function of it.
  template <typename Cell>
  RowColumn(tables::Column title, Cell of)
      : heading(std::move(title)),
        cell([of](const Row& row) { return text_of(std::invoke(of, row)); }) {}

  tables::Column heading;
  std::function<std::string(const Row& row)> cell;
};

template <typename Row>
using RowColumns = std::vector<RowColumn<Row>>;

template <typename Row>
auto age(std::int64_t Row::*time_ms) {
  return [time_ms, now = now_ms()](const Row& row) { return age_text(row.*time_ms, now); };
}

template <typename Row>
auto time(std::int64_t Row::*time_ms) {
  return [time_ms](const Row& row) { return row.*time_ms == 0 ? "-" : time_text(row.*time_ms); };
}

template <typename Row>
auto or_none(std::string Row::*text) {
  return [text](const Row& row) { return (row.*text).empty() ? "-" : row.*text; };
}

RowColumns<BackupSummary> columns_of_backups(link::Client& /*server*/) {
  using Row = BackupSummary;
  return {{"NAME", &Row::name},
          {"SIZE", [](const Row& backup) { return size_text(backup.bytes); }},
          {"AGE", age(&Row::modified_ms)},
          {{"WRITTEN", Fit::Wide}, time(&Row::modified_ms)}};
}

RowColumns<RobotSummary> columns_of_robots(link::Client& /*server*/) {
  using Row = RobotSummary;
  return {{"ROBOT", &Row::robot},
          {{"LABEL", Fit::Cut}, &Row::label},
          {"DOF", &Row::dof},
          {{"CHAIN", Fit::Cut},
           [](const Row& robot) { return robot.base_link + " -> " + robot.tip_link; }},
          {"PATHS", &Row::paths},
          {"ATTEMPTS", &Row::attempts},
          {"AGE", age(&Row::registered_ms)},
          {{"REGISTERED", Fit::Wide}, time(&Row::registered_ms)}};
}

RowColumns<TaskSummary> columns_of_tasks(link::Client& /*server*/) {
  using Row = TaskSummary;
  return {{"TASK", &Row::task},
          {"ROBOTS", [](const Row& task) { return task.robots.size(); }},
          {"PATHS", [](const Row& task) { return kept_text(task.paths, task.dropped); }},
          {"ATTEMPTS", &Row::attempts}};
}

std::string state_text(const PathSummary& path) {
  if (path.retired_ms == 0)
    return "-";
  return path.dropped ? "dropped" : "retired";
}

RowColumns<PathSummary> columns_of_paths(link::Client& /*server*/) {
  using Row = PathSummary;
  const auto record = [](auto PlanningRecord::*member) {
    return [member](const Row& path) { return path.record.*member; };
  };
  return {{"PATH", &Row::report_uuid},
          {{"ROBOT", Fit::Cut}, &Row::label},
          {{"TASK", Fit::Cut}, &Row::task},
          {"CHECKS", record(&PlanningRecord::collision_checks)},
          {"AGE", age(&Row::received_ms)},
          {"STATE", state_text},
          {{"WAYPOINTS", Fit::Wide}, &Row::waypoints},
          {{"LENGTH", Fit::Wide}, [](const Row& path) { return number_text(path.length, 2); }},
          {{"TIME_S", Fit::Wide},
           [](const Row& path) { return number_text(path.record.planning_time_s, 3); }},
          {{"PLANNER", Fit::Wide}, record(&PlanningRecord::planner)},
          {{"MODE", Fit::Wide}, record(&PlanningRecord::sampling_mode)},
          {{"MACHINE", Fit::Wide}, &Row::machine},
          {{"RECEIVED", Fit::Wide}, time(&Row::received_ms)},
          {{"RETIRED", Fit::Wide}, time(&Row::retired_ms)}};
}

/// Why it was not solved, in a few lines of a narrow column; `attempts show` has all.
std::string short_why_text(const AttemptSummary& attempt) {
  constexpr std::size_t kMost = 120;
  if (attempt.record.outcome == Outcome::Solved || attempt.why.empty())
    return "-";
  return attempt.why.size() <= kMost ? attempt.why : cut_text(attempt.why, kMost) + "..";
}

RowColumns<AttemptSummary> columns_of_attempts() {
  using Row = AttemptSummary;
  const auto record = [](auto PlanningRecord::*member) {
    return [member](const Row& row) { return row.record.*member; };
  };
  constexpr std::size_t kShort = 8;  // enough for the next command
  return {{"ATTEMPT", [](const Row& row) { return row.report_uuid.text().substr(0, kShort); }},
          {{"ROBOT", Fit::Cut}, &Row::label},
          {{"TASK", Fit::Cut}, &Row::task},
          {"OUTCOME", record(&PlanningRecord::outcome)},
          {"TIME_S", [](const Row& row) { return number_text(row.record.planning_time_s, 3); }},
          {"CHECKS", record(&PlanningRecord::collision_checks)},
          {"AGE", age(&Row::received_ms)},
          {"WHY", short_why_text},
          {{"LENGTH", Fit::Wide},
           [](const Row& row) { return row.length > 0 ? number_text(row.length, 2) : "-"; }},
          {{"PLANNER", Fit::Wide}, record(&PlanningRecord::planner)},
          {{"MODE", Fit::Wide}, record(&PlanningRecord::sampling_mode)},
          {{"MACHINE", Fit::Wide}, &Row::machine},
          {{"RECEIVED", Fit::Wide}, time(&Row::received_ms)},
          {{"REPORT", Fit::Wide}, &Row::report_uuid},
          {{"WHY IN FULL", Fit::Wide}, or_none(&Row::why)}};
}

/// Labels of robots by their digests, asked for when the first is wanted.
class RobotLabels {
 public:
  explicit RobotLabels(link::Client& server) : server_(&server) {}

  /// The short digest of a robot that the server does not list.
  std::string of(const Digest& robot) {
    if (!labels_)
      read();
    const auto known = labels_->find(robot);
    return known == labels_->end() ? robot.short_hex() : known->second;
  }

 private:
  void read() {
    labels_.emplace();
    // Without an answer digests do.
    static_cast<void>(link::for_each_row(
        *server_, {.verb = AdminVerb::ListRobots}, [this](const std::string& row) {
          if (const auto robot = json::row_from_json<RobotSummary>(row))
            labels_->emplace(robot->robot, robot->label);
          return true;
        }));
  }

  link::Client* server_;
  std::optional<std::map<Digest, std::string>> labels_;
};

/// Profile and selection: "default, by sources, only panda iiwa14, since 2026-11-21T05:32:00Z".
std::string made_of_text(const DistributionSummary& distribution, RobotLabels& labels) {
  const Selection& selection = distribution.selection;
  std::string text = distribution.profile;
  if (selection.weighting)
    text += ", by " + std::string(to_text(*selection.weighting));
  if (!selection.sources.empty())
    text += ", only";
  for (const Digest& robot : selection.sources)
    text += " " + labels.of(robot);
  if (selection.since_ms > 0)
    text += ", since " + time_text(selection.since_ms);
  return text;
}

RowColumns<DistributionSummary> columns_of_distributions(link::Client& server) {
  using Row = DistributionSummary;
  return {
      {"DISTRIBUTION", &Row::id},
      {{"ROBOT", Fit::Cut}, &Row::label},
      {{"TASK", Fit::Cut}, &Row::task},
      {"STATE", [](const Row& row) { return row.retired ? "retired" : text_of(row.state); }},
      {"AGE", age(&Row::fitted_ms)},
      {"PLACEMENT",
       [](const Row& row) { return row.T_task_base ? short_pose_text(*row.T_task_base) : "-"; }},
      {"MADE OF", [labels = std::make_shared<RobotLabels>(server)](
                      const Row& row) { return made_of_text(row, *labels); }},
      {{"REVISION", Fit::Wide}, &Row::revision},
      {{"K", Fit::Wide}, &Row::components},
      {{"CONFIGURATIONS", Fit::Wide}, &Row::configurations},
      {{"PATHS", Fit::Wide}, &Row::paths},
      {{"FITTED", Fit::Wide}, time(&Row::fitted_ms)}};
}

RowColumns<Job> columns_of_jobs(link::Client& /*server*/) {
  return {{"JOB", &Job::id},
          {"VERB", &Job::verb},
          {"STATE", &Job::state},
          {"PROGRESS", [](const Job& job) { return percent_text(job.progress); }},
          {"AGE", age(&Job::started_ms)},
          {"ARGUMENT", &Job::argument},
          {"MESSAGE", &Job::message},
          {{"ROWS", Fit::Wide}, &Job::rows},
          {{"STARTED", Fit::Wide}, time(&Job::started_ms)}};
}

std::string labels_text(const ClientUse& client) {
  std::string text;
  for (const std::string& label : client.robots)
    text += (text.empty() ? "" : ", ") + label;
  return text.empty() ? "-" : text;
}

/// "12, last for bytes".
std::string refused_text(const ClientUse& client) {
  const std::string count = std::to_string(client.refused);
  return client.refused_for.empty() ? count : count + ", last for " + client.refused_for;
}

RowColumns<ClientsOfName> columns_of_clients() {
  using Row = ClientsOfName;
  const auto of = [](auto ClientUse::*member) {
    return [member](const Row& row) { return row.use.*member; };
  };
  const auto bytes_text = [](const Row& row) {
    return size_text(static_cast<std::uint64_t>(row.use.bytes_per_s));
  };
  return {
      {{"CLIENT", Fit::Cut}, of(&ClientUse::client)},
      {"CALLS", &Row::clients},
      {{"ROBOTS", Fit::Cut}, [](const Row& row) { return labels_text(row.use); }},
      {"REQUESTS", of(&ClientUse::requests)},
      {"BAD", of(&ClientUse::bad_requests)},
      {"BYTES/S", bytes_text},
      {"WAITING", [](const Row& row) { return row.use.on_way + row.use.waiting; }},
      {"REFUSED", [](const Row& row) { return refused_text(row.use); }},
      {"SEEN", [now = now_ms()](const Row& row) { return age_text(row.use.last_seen_ms, now); }},
      {{"ATTEMPTS/S", Fit::Wide},
       [](const Row& row) { return number_text(row.use.attempts_per_s, 1); }},
      {{"LEASES", Fit::Wide}, of(&ClientUse::leases)},
      {{"FITS", Fit::Wide}, of(&ClientUse::fits)},
      {{"ATTEMPTS", Fit::Wide}, of(&ClientUse::attempts)},
      {{"NEW ROBOTS", Fit::Wide}, of(&ClientUse::registered_robots)},
      {{"NEW TASKS", Fit::Wide}, of(&ClientUse::created_tasks)},
      {{"STORED", Fit::Wide}, [](const Row& row) { return size_text(row.use.stored_bytes); }}};
}

std::string place_text(const AuditEntry& entry) {
  return entry.is_local ? "this machine" : "another host";
}

/// With how the server knows it, where the log has that: "address 10.0.0.7, token shown".
std::string known_place_text(const AuditEntry& entry) {
  const auto end = entry.client.find(", ");
  return end == std::string::npos ? place_text(entry) : entry.client.substr(end + 2);
}

RowColumns<AuditEntry> columns_of_audit() {
  using Row = AuditEntry;
  return {{"AGE", age(&Row::time_ms)},
          {{"WHO", Fit::Cut},
           [](const Row& entry) { return entry.name.empty() ? place_text(entry) : entry.name; }},
          {"ACT", &Row::verb},
          {{"TARGET", Fit::Cut}, or_none(&Row::target)},
          {"OUTCOME", &Row::outcome},
          {{"WHAT CAME OF IT", Fit::Cut},
           [](const Row& entry) {
             return or_none(entry.message.empty() ? &Row::after : &Row::message)(entry);
           }},
          {{"BEFORE", Fit::Wide}, or_none(&Row::before)},
          {{"ROLE", Fit::Wide}, or_none(&Row::role)},
          {{"CLIENT", Fit::Wide},
           [](const Row& entry) {
             const std::string client = entry.client.substr(0, entry.client.find(", "));
             return client.empty() ? "-" : client;
           }},
          {{"FROM", Fit::Wide}, known_place_text},
          {{"WHEN", Fit::Wide}, time(&Row::time_ms)}};
}

template <typename Row>
std::vector<std::string> cells_of(const Row& row, const RowColumns<Row>& columns) {
  std::vector<std::string> cells;
  for (const RowColumn<Row>& column : columns)
    cells.push_back(column.cell(row));
  return cells;
}

template <typename Row>
tables::Table table_of(const RowColumns<Row>& columns) {
  std::vector<tables::Column> headings;
  for (const RowColumn<Row>& column : columns)
    headings.push_back(column.heading);
  return tables::Table(std::move(headings));
}

struct Query {
  std::string command;  ///< named in messages
  AdminRequest request;
  std::size_t limit = 0;  ///< rows in all; 0: every one
  bool json = false;
};

/// The selection of a listing that shows each row.
struct EveryRow {
  template <typename Row>
  bool takes(const Row& /*row*/) const noexcept {
    return true;
  }
  bool is_full() const noexcept { return false; }
};

/// Asks for rows and prints them; JSON as it came. \return an exit code.
/// \param selection  as AuditSelection.
template <typename Row, typename Selection = EveryRow>
int list_rows(link::Client& server, const Query& query, const RowColumns<Row>& columns,
              std::ostream& out, std::ostream& err, Selection selection = {}) {
  tables::Table table = table_of(columns);
  std::string document = "{\"rows\":[";
  std::optional<Error> error;
  const auto add = [&](const std::string& text) {
    constexpr bool kTakesEvery = std::is_same_v<Selection, EveryRow>;
    Result<Row> row = Row();
    if (!(query.json && kTakesEvery))
      row = json::row_from_json<Row>(text);
    if (!row) {
      error = link::unreadable_row(row.error());
      return false;
    }
    if (!selection.takes(*row))
      return !selection.is_full();
    if (query.json)
      document += (document.back() == '[' ? "\n" : ",\n") + text;
    else
      table.add_row(cells_of(*row, columns));
    return !selection.is_full();
  };
  if (const auto failed = link::for_each_row(server, query.request, add, query.limit))
    error = failed;
  if (error)
    return refuse(query.command, *error, err);
  if (query.json)
    out << json::in_format(json::kListFormatOf<Row>, document + "\n]}") << '\n';
  else
    table.print(out);
  return kDone;
}

template <auto columns>
int list(link::Client& server, const Query& query, std::ostream& out, std::ostream& err) {
  return list_rows(server, query, columns(server), out, err);
}

/// A command that lists rows without further ado.
struct Listing {
  std::string_view noun, verb, what;
  AdminVerb rows;
  int (*list)(link::Client& server, const Query& query, std::ostream& out, std::ostream& err);
};

constexpr std::array kListings = {
    Listing{"backup", "list", "List backups", AdminVerb::ListBackups, list<columns_of_backups>},
    Listing{"distributions", "list", "List distributions", AdminVerb::ListDistributions,
            list<columns_of_distributions>},
    Listing{"jobs", "list", "List jobs", AdminVerb::ListJobs, list<columns_of_jobs>},
    Listing{"paths", "list", "List paths", AdminVerb::ListPaths, list<columns_of_paths>},
    Listing{"robots", "list", "List robots", AdminVerb::ListRobots, list<columns_of_robots>},
    Listing{"tasks", "list", "List tasks", AdminVerb::ListTasks, list<columns_of_tasks>}};

void add_listing(CLI::App& noun, const Listing& listing, Session& session) {
  const auto query = std::make_shared<Query>();
  query->command = std::string(listing.noun) + " " + std::string(listing.verb);
  query->request.verb = listing.rows;
  CLI::App* command = add_command(noun, std::string(listing.verb), std::string(listing.what),
                                  "kinship " + query->command + " --json");
  constexpr std::size_t kMostRows = 1'000'000'000;
  command->add_option("--limit", query->limit, "Rows at most (default: all)")
      ->check(CLI::Range(std::size_t{0}, kMostRows));
  if (rule_of(listing.rows).is(VerbRule::Filters)) {
    command->add_option("--task", query->request.task, "Of this task")->type_name("TASK");
    command->add_option("--robot", query->request.robot, "Of this robot: label or digest prefix")
        ->type_name("ROBOT");
  }
  add_json(*command, session);
  on_run_with_server(*command, session, [&session, &listing, query](link::Client& server) {
    query->json = session.json;
    return listing.list(server, *query, session.out, session.err);
  });
}

}  // namespace

void add_listings(CLI::App& noun, Session& session) {
  for (const Listing& listing : kListings)
    if (listing.noun == noun.get_name())
      add_listing(noun, listing, session);
}

int list_clients(link::Client& server, std::size_t limit, bool json, std::ostream& out,
                 std::ostream& err) {
  constexpr const char* kCommand = "status --clients";
  if (json)
    return list_rows(server, {kCommand, {.verb = AdminVerb::ListClients}, limit, json},
                     RowColumns<ClientUse>(), out, err);
  std::vector<ClientUse> clients;
  std::optional<Error> unreadable;
  std::optional<Error> error =
      link::for_each_row(server, {.verb = AdminVerb::ListClients}, [&](const std::string& text) {
        Result<ClientUse> row = json::row_from_json<ClientUse>(text);
        if (row)
          clients.push_back(std::move(row).value());
        else
          unreadable = link::unreadable_row(row.error());
        return !unreadable;
      });
  if (error || unreadable)
    return refuse(kCommand, error ? *error : *unreadable, err);
  const RowColumns<ClientsOfName> columns = columns_of_clients();
  tables::Table table = table_of(columns);
  std::vector<ClientsOfName> names = by_name(clients);
  if (limit > 0 && names.size() > limit)
    names.resize(limit);
  for (const ClientsOfName& name : names)
    table.add_row(cells_of(name, columns));
  table.print(out);
  return kDone;
}

int list_attempts(link::Client& server, const AttemptListOptions& options, std::ostream& out,
                  std::ostream& err) {
  return list_rows(server,
                   {"attempts list",
                    {.verb = AdminVerb::FindAttempts,
                     .argument = to_text(options.filter),
                     .robot = options.robot,
                     .task = options.task},
                    options.limit,
                    options.json},
                   columns_of_attempts(), out, err);
}

int list_audit(link::Client& server, const AuditOptions& options, std::ostream& out,
               std::ostream& err) {
  return list_rows(server,
                   {"audit",
                    {.verb = AdminVerb::ListAudit, .argument = options.who},
                    options.since_ms > 0 ? 0 : options.limit,
                    options.json},
                   columns_of_audit(), out, err, AuditSelection(options.since_ms, options.limit));
}

}  // namespace kinship::cli
