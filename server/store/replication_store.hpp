#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/digest.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/replicated_report.hpp"
#include "server/store/report_store.hpp"

namespace kinship::store {

/// Exchanges reports with another store (replicated_report.hpp); see Store.
///
/// A feed is in the order of arrival; its cursor is opaque text, empty for the beginning, and holds
/// for one epoch. With any number of writers, rows committed before a reading begins and behind its
/// cursor are in it, or in one from the cursor that it returns; no row is skipped because another
/// transaction committed sooner. A feed throws Failure(InvalidInput) for a cursor of another list.
class ReplicationStore {
 public:
  /// The reports of a task, or of all if it is empty: unsolved ones too, and those of retired and
  /// dropped paths.
  virtual Feed<ArrivedReport> list_arrivals(std::string_view task, std::string_view cursor,
                                            std::size_t limit) const = 0;
  /// Every report whose path was retired here, or by a retirement from another store; each once.
  /// Dropped paths are not among them.
  virtual Feed<Uuid> list_retirements(std::string_view cursor, std::size_t limit) const = 0;
  /// The given reports that this store has, with the digests of their bodies.
  virtual std::map<Uuid, Digest> known_reports(std::span<const Uuid> reports) const = 0;
  /// Reports with their paths and scenes, also of retired paths, in the order asked for. Left out:
  /// reports that are missing or unreadable, solved ones that lost their path (dropped, damaged),
  /// and those of a removed robot. Ends early once waypoints and scenes exceed `max_bytes`, but
  /// looks at one at least.
  virtual ReplicatedReports read_reports(std::span<const Uuid> reports,
                                         std::size_t max_bytes) const = 0;
  /// ReportStore::commit_reports() for reports from another store: body and time are kept, and a
  /// path that is retired, or whose report is among the retired ones, is stored as retired and
  /// answered Recorded. The same then holds for such a path from a robot. A known report that is
  /// retired there is retired here.
  virtual void commit_replicated(std::vector<ReplicatedReport> reports,
                                 ReportStore::ReportsDone done) = 0;
  /// Why a report was answered TryAgain by itself, while others were stored: lately the database
  /// did not take it. From memory.
  virtual std::optional<std::string> why_put_off(const Uuid& report) const = 0;
  /// Retires the paths of reports that another store retired, durable on return, in one
  /// transaction. The UUID of an unknown report is kept, so that its path is retired on arrival.
  /// \return the newly retired paths, by task.
  virtual std::vector<Retirement> retire_reports(std::span<const Uuid> reports) = 0;

  /// Short texts that a part of the server keeps by name; the ones whose names begin with `prefix`.
  virtual std::map<std::string, std::string> notes(std::string_view prefix) const = 0;
  /// Writes all of them or none, durable on return; a note without text is removed.
  virtual void put_notes(const std::map<std::string, std::optional<std::string>>& notes) = 0;

 protected:
  ~ReplicationStore() = default;
};

}  // namespace kinship::store
