#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

/// Exchange of reports between stores (server/sites). Reports are only added and paths only
/// retired, so two stores become equal by adding missing reports and retirements, in any order and
/// any number of times.
namespace kinship::store {

/// A report on its way from one store to another.
struct ReplicatedReport {
  Attempt attempt;
  /// Digest of the report as its robot sent it: tells a retry from a second use of the UUID. It is
  /// sent along, as a placement that was stored and read again may differ in its last bit.
  Digest body;
  std::int64_t received_ms = 0;  ///< arrival at the first store that had it
  bool is_retired = false;       ///< no fit uses its path, here and at the receiver
};

/// A report that a store has.
struct ArrivedReport {
  Uuid report_uuid;
  bool is_retired = false;  ///< its path
  Digest body;              ///< as ReplicatedReport::body
};

/// A part of a list that only grows, and the cursor of the next reading.
template <typename Row>
struct Feed {
  std::vector<Row> rows;
  std::string cursor;     ///< behind the last row read; the caller's if there is none
  bool has_more = false;  ///< more rows follow
};

/// Reports that were read whole.
struct ReplicatedReports {
  std::vector<ReplicatedReport> reports;
  /// Requested reports that were looked at, from the first; the others exceed the bytes.
  std::size_t looked_at = 0;
};

}  // namespace kinship::store
