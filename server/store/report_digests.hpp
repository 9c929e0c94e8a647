#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"
#include "server/store/replicated_report.hpp"

namespace kinship::store {

/// The reports of a store by the digests of their bodies. The store is left as it is (no lock, no
/// migration, no run), and servers may have it open. Used by one thread. Methods throw
/// Failure(Storage), and Failure(Unavailable) once a server opens a file that was at rest.
class ReportDigests {
 public:
  ReportDigests() = default;
  ReportDigests(const ReportDigests&) = delete;
  ReportDigests& operator=(const ReportDigests&) = delete;
  virtual ~ReportDigests() = default;

  /// As ReplicationStore::list_arrivals() of all tasks: without damaged reports.
  virtual Feed<ArrivedReport> list_arrivals(std::string_view cursor, std::size_t limit) = 0;
  /// The given reports that the store has; without a digest: the row is damaged.
  virtual std::map<Uuid, std::optional<Digest>> known_reports(std::span<const Uuid> reports) = 0;
};

/// Opens the store of this name (open_store.hpp) to read its digests.
/// \throws Failure(NotFound) if there is none; Failure(InvalidInput) if the name is of no store;
///         Failure(Storage) if it has another schema than this binary, which is left to it, or
///         cannot be read.
std::unique_ptr<ReportDigests> open_report_digests(const std::string& name);

}  // namespace kinship::store
