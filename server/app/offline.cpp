#include "server/app/offline.hpp"

#include <iomanip>
#include <ostream>
#include <string>

#include "proto/json/store_check_json.hpp"
#include "proto/types/failure.hpp"
#include "server/store/maintenance.hpp"
#include "server/store/open_store.hpp"

namespace kinship::app {
namespace {

/// Whole percents on one line of a terminal, which is empty again at the end.
class ProgressLine {
 public:
  ProgressLine(std::ostream& err, bool show) : err_(&err), show_(show) {}
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  ~ProgressLine() {
    if (percent_ >= 0)
      *err_ << "\r     \r" << std::flush;
  }

  void show(double progress) {
    const int percent = static_cast<int>(100 * progress);
    if (!show_ || percent == percent_)
      return;
    percent_ = percent;
    *err_ << '\r' << std::setw(3) << percent << " %" << std::flush;
  }

 private:
  std::ostream* err_;
  bool show_;
  int percent_ = -1;
};

void print(const StoreCheck& check, std::ostream& out) {
  out << "store '" << check.file << "': schema " << check.schema_version << ", written by "
      << (check.release.empty() ? "a build before 0.2.0" : check.release) << ", epoch "
      << check.epoch.text() << ", " << check.bytes << " bytes\n";
  for (const StoreCheck::Table& table : check.tables)
    out << "  " << std::left << std::setw(24) << table.name << std::right << std::setw(12)
        << table.rows << " rows" << std::setw(8) << table.problems << " problems\n";
  out << check.retired_paths << " paths are retired, " << check.damaged_paths
      << " were quarantined before\n";
  for (const std::string& message : check.messages)
    out << message << '\n';
  if (check.problems > check.messages.size())
    out << "and " << check.problems - check.messages.size() << " more\n";
  out << (check.problems == 0 ? "sound" : std::to_string(check.problems) + " problems") << '\n';
}

int check(const OfflineOptions& options, const store::Progress& progress, std::ostream& out) {
  const StoreCheck found = store::check_store(options.store, progress);
  if (options.json)
    out << json::to_json(found) << '\n';
  else
    print(found, out);
  return found.problems == 0 ? kDone : kFailed;
}

int backup(const OfflineOptions& options, const store::Progress& progress, std::ostream& out) {
  const std::uint64_t bytes = store::backup_store(options.store, options.file, progress);
  out << "backup '" << options.file.string() << "': " << bytes << " bytes\n";
  return kDone;
}

int restore(const OfflineOptions& options, const store::Progress& progress, std::ostream& out) {
  const store::Restored restored = store::restore_store(options.file, options.store, progress);
  out << "store '" << options.store.string() << "': restored from '" << options.file.string()
      << "', epoch " << restored.epoch.text() << '\n';
  if (!restored.replaced.empty())
    out << "the store that was there is now '" << restored.replaced.string() << "'\n";
  for (const std::filesystem::path& leftover : restored.leftovers)
    out << "left by an earlier restore: '" << leftover.string() << "'\n";
  return kDone;
}

void print(const store::Repaired::Table& table, std::ostream& out) {
  out << "table " << table.name << ": " << (table.is_before_known ? "" : "at least ")
      << table.before << " rows before, " << table.after << " after";
  if (table.again > 0)
    out << ", " << table.again << " damaged that were sent again since";
  out << ", " << table.missing.size() << " missing\n";
  for (const store::Repaired::Table::Missing& row : table.missing) {
    out << "missing: " << table.name << ' ' << row.id;
    if (row.report)
      out << ", report " << row.report->text();
    out << '\n';
  }
}

int repair(const OfflineOptions& options, const store::Progress& progress, std::ostream& out) {
  const store::Repaired repaired = store::repair_store(options.store, progress);
  out << "store '" << options.store.string() << "': written anew, epoch "
      << repaired.restored.epoch.text() << "; " << repaired.damaged_places
      << " damaged places were left behind\n";
  for (const store::Repaired::Lost& lost : repaired.lost) {
    out << "lost: " << lost.rows << ' ' << lost.table << (lost.rows == 1 ? "" : "s");
    if (!lost.robot.empty())
      out << (lost.table == "robot" ? " '" : " of robot '") << lost.robot << "'";
    if (!lost.task.empty())
      out << ", task '" << lost.task << "'";
    out << '\n';
  }
  for (const store::Repaired::Table& table : repaired.tables)
    print(table, out);
  for (const std::string& problem : repaired.check.messages)
    out << "still wrong: " << problem << '\n';
  const bool is_whole = repaired.check.problems == 0;
  if (repaired.lost.empty() && is_whole)
    out << "nothing was lost\n";
  else
    out << "clients offer again what they still have; each robot that was lost or is wrong needs "
           "'kinship robots register' or the next start of its planner\n";
  out << "mixtures are fitted again when they are asked for\n"
      << "the damaged store is now '" << repaired.restored.replaced.string() << "'\n";
  for (const std::filesystem::path& leftover : repaired.restored.leftovers)
    out << "left by an earlier repair or restore: '" << leftover.string() << "'\n";
  return is_whole ? kDone : kFailed;
}

int migrate(const OfflineOptions& options, std::ostream& out) {
  const store::Migrated migrated = store::migrate_store(options.store);
  out << "store '" << options.store.string() << "': schema " << migrated.to;
  if (migrated.from == migrated.to)
    out << " already\n";
  else
    out << ", was " << migrated.from << "; as it was: '" << migrated.backup.string() << "'\n";
  return kDone;
}

/// Why a verb does not work on a PostgreSQL database, and which tool does its work there.
std::string alternative_to(OfflineVerb verb) {
  switch (verb) {
    case OfflineVerb::Check:
      return "check: a PostgreSQL database checks its own pages (pg_amcheck; initdb "
             "--data-checksums)";
    case OfflineVerb::Backup:
      return "backup: pg_dump, pg_basebackup or pgBackRest copy a PostgreSQL database";
    case OfflineVerb::Restore:
      return "restore: pg_restore, or pgBackRest, puts back a PostgreSQL database; servers notice, "
             "and "
             "clients offer again what it lacks";
    case OfflineVerb::Repair:
      return "repair: a PostgreSQL database is repaired from its standby or its backup";
    case OfflineVerb::Migrate:
      return "migrate: the first server of a new version migrates a PostgreSQL database when it "
             "starts; copy it before with pg_dump";
  }
  return {};
}

int run(const OfflineOptions& options, const store::Progress& progress, std::ostream& out) {
  const std::string name = options.store.string();
  if (store::kind_of_store(name).value_or_throw() == store::StoreKind::PostgresDatabase)
    throw Failure(ErrorCode::InvalidInput,
                  "store '" + store::displayed_store(name) + "': " + alternative_to(options.verb));
  switch (options.verb) {
    case OfflineVerb::Check:
      return check(options, progress, out);
    case OfflineVerb::Backup:
      return backup(options, progress, out);
    case OfflineVerb::Restore:
      return restore(options, progress, out);
    case OfflineVerb::Repair:
      return repair(options, progress, out);
    case OfflineVerb::Migrate:
      return migrate(options, out);
  }
  return kWrongUsage;
}

}  // namespace

int run_offline(const OfflineOptions& options, std::ostream& out, std::ostream& err,
                bool show_progress) {
  try {
    ProgressLine line(err, show_progress);
    return run(
        options, [&line](double progress) { line.show(progress); }, out);
  } catch (const Failure& failure) {
    err << "kinshipd: " << failure.what() << '\n';
    // A server that has the store open is a failure here; code 4 speaks of servers that answer.
    return failure.code() == ErrorCode::Unavailable ? kFailed : exit_code(failure.code());
  }
}

}  // namespace kinship::app
