#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/uuid.hpp"

/// What one store has that another one is to have, too (server/sites). Reports are only added and
/// paths only retired, so what two stores have is brought together by adding what is missing, in
/// any order and as often as one likes.
namespace kinship::store {

/// A report as it goes from one store to another.
struct SharedReport {
  Attempt attempt;
  /// Of the report as its robot sent it: tells a retry from a second use of the UUID. It goes
  /// along, as a placement that was stored and read again may differ in its last bit.
  Digest body;
  std::int64_t received_ms = 0;  ///< when it came to the first store that had it
  bool is_retired = false;       ///< its path is in no fit, and is to be in none
};

/// A report that is there.
struct ArrivedReport {
  Uuid report_uuid;
  bool is_retired = false;  ///< its path
};

/// Some of a list that only grows, and where the next reading begins.
template <typename Row>
struct Feed {
  std::vector<Row> rows;
  std::string cursor;  ///< behind the last row that was looked at; that asked for if there is none
  bool has_more = false;  ///< there was more than asked for
};

/// Reports that were read whole.
struct SharedReports {
  std::vector<SharedReport> reports;
  std::size_t looked_at =
      0;  ///< of those asked for, the first ones; the others were too many bytes
};

}  // namespace kinship::store
