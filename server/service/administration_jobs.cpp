// The verbs that begin jobs, are about jobs, or read the results of jobs.

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "proto/types/base64.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/sha256.hpp"
#include "server/service/administration.hpp"
#include "server/service/export_configurations.hpp"

namespace kinship::service {
namespace {

/// There is no room for a job now.
AdminPage page_of_later(const Error& error) {
  constexpr RetryAfter kJobEnds{5000};
  AdminPage page = page_of(error);
  page.status = AdminStatus::Failed;
  page.retry_after = kJobEnds;
  return page;
}

/// \return false if it was to stop.
bool hash(const BackupFile& file, JobRun& run) {
  constexpr std::size_t kStep = std::size_t{1} << 20U;
  Sha256 digest;
  const BackupSummary& summary = file.summary();
  for (std::uint64_t place = 0; place < summary.bytes;) {
    if (run.should_stop())
      return false;
    const std::vector<std::uint8_t> bytes = file.read(place, kStep);
    if (bytes.empty())
      throw Failure(ErrorCode::Storage, "backup '" + summary.name + "': became shorter");
    digest.add(std::span<const std::uint8_t>(bytes));
    place += bytes.size();
    run.set_progress(static_cast<double>(place) / static_cast<double>(summary.bytes));
  }
  const std::string hex = digest.finish().hex();
  run.rows.add(hex);
  run.rows.add(std::to_string(summary.bytes));
  run.message = std::to_string(summary.bytes) + " bytes, SHA-256 " + hex;
  return true;
}

/// The job that reads a backup through; its rows are the SHA-256 digest of its bytes in hexadecimal
/// digits, and their number: a client that then reads the bytes sees that all are there. Reading
/// them needs no job, so it goes on after a restart, which ends jobs.
Jobs::Task hash_backup_job(BackupFile file, const std::string& request_key) {
  // Shared, for a std::function is copyable.
  const auto shared = std::make_shared<const BackupFile>(std::move(file));
  return Jobs::Task{.verb = "hash backup",
                    .argument = shared->summary().name,
                    .request_key = request_key,
                    .run = [shared](JobRun& run) { return hash(*shared, run); }};
}

/// Some bytes of a backup in base64, from a place on; no row behind its end.
AdminPage read_backup_from(const BackupFile& file, std::size_t begin) {
  const std::vector<std::uint8_t> bytes = file.read(begin, kMaxBackupChunkBytes);
  AdminPage page;
  page.status = AdminStatus::Ok;
  if (!bytes.empty())
    page.rows.emplace_back(TextLine{to_base64(bytes)});
  if (const std::uint64_t end = begin + bytes.size(); !bytes.empty() && end < file.summary().bytes)
    page.next_cursor = std::to_string(end);
  return page;
}

}  // namespace

AdminPage Administration::job_rows(const Call& call) {
  const std::size_t first = row_number(call.request.cursor).value_or_throw();
  Jobs::RowPage rows =
      parts_.jobs.rows(call.request.argument, first, page_size(call.request), kMaxPageBytes)
          .value_or_throw();
  AdminPage page;
  page.status = AdminStatus::Ok;
  for (std::string& row : rows.rows)
    page.rows.emplace_back(TextLine{std::move(row)});
  if (rows.next > 0)
    page.next_cursor = std::to_string(rows.next);
  return page;
}

AdminPage Administration::export_configurations(const Call& call) {
  const fitting::FitContext context{.store = parts_.store,
                                    .robots = parts_.robots,
                                    .clock = parts_.clock,
                                    .memory = parts_.memory};
  return begin(
      export_configurations_job(context, find_distribution(call.request.argument), call.key),
      call.audit);
}

AdminPage Administration::list_backups(const Call& call) {
  const std::filesystem::path store_file = parts_.store.status().file;
  const std::filesystem::path folder = folder_of(parts_.backups, store_file).value_or_throw();
  return page_of(find_backups(folder, store_file), call.request);
}

BackupFile Administration::open_backup(const std::string& name) const {
  const std::filesystem::path store_file = parts_.store.status().file;
  const std::filesystem::path folder = folder_of(parts_.backups, store_file).value_or_throw();
  return BackupFile::open(folder, name, store_file).value_or_throw();
}

AdminPage Administration::back_up(const Call& call) {
  return begin_audited(backup_job(parts_.store, call.request.argument, parts_.backups, call.key),
                       call.audit);
}

/// In the audit log once, for the reading that follows.
AdminPage Administration::hash_backup(const Call& call) {
  BackupFile file = open_backup(call.request.argument);
  const BackupSummary backup = file.summary();
  AdminPage page = begin_audited(hash_backup_job(std::move(file), call.key), call.audit);
  if (page.status == AdminStatus::Ok)
    downloads_.add(call.audit.client, backup);
  return page;
}

/// A reading without a digest, as after a restart, is in the audit log before the first byte.
AdminPage Administration::read_backup(const Call& call) {
  const AuditEntry& audit = call.audit;
  const std::size_t begin = row_number(call.request.cursor).value_or_throw();
  const BackupFile file = open_backup(call.request.argument);
  AdminPage page = read_backup_from(file, begin);
  if (downloads_.has(audit.client, file.summary()))
    return page;
  trail_.hand_out(audit, "read from byte " + std::to_string(begin) + " on of " +
                             std::to_string(file.summary().bytes));
  downloads_.add(audit.client, file.summary());
  return page;
}

/// Of one's own job, or one that has ended, there is nothing to answer for.
AdminPage Administration::cancel_job(const Call& call) {
  const std::string& id = call.request.argument;
  const AuditEntry& audit = call.audit;
  const Job job = parts_.jobs.find(id).value_or_throw();
  if (has_ended(job.state) || parts_.jobs.owner_of(id) == audit.client)
    return page_of(parts_.jobs.cancel(id));
  const std::string before = job.verb + " " + job.argument + ": " + std::string(to_text(job.state));
  trail_.begin(audit, before);
  Result<Job> cancelled = parts_.jobs.cancel(id);
  if (cancelled)
    trail_.end(audit, before, "told to end: " + std::string(to_text(cancelled->state)));
  return page_of(std::move(cancelled));
}

/// A job that is in the audit log as begun, and as it ended.
AdminPage Administration::begin_audited(Result<Jobs::Task> task, const AuditEntry& audit) {
  Jobs::Task begun = std::move(task).value_or_throw();
  if (const auto refusal = parts_.jobs.refusal_of(audit.client))
    return page_of_later(*refusal);
  trail_.begin(audit, "");
  begun.on_end = trail_.ending(audit);
  return begin(std::move(begun), audit);
}

AdminPage Administration::begin(Result<Jobs::Task> task, const AuditEntry& audit) {
  Jobs::Task begun = std::move(task).value_or_throw();
  begun.owner = audit.client;
  Result<Job> job = parts_.jobs.begin(std::move(begun));
  return job ? page_of(std::move(job).value()) : page_of_later(job.error());
}

}  // namespace kinship::service
