#pragma once

#include <cstddef>
#include <cstdint>

#include "proto/types/audit.hpp"

namespace kinship::cli {

/// Selects the audit entries to show: the newest since a time, at most a number of them. Entries
/// arrive in the order of their making, the newest first; their times may break that order, as
/// after a restored store or a clock set back, so that an old entry does not end the selection.
class AuditSelection {
 public:
  /// \param since_ms  Unix time, UTC; 0: all.
  /// \param limit     0: every one.
  AuditSelection(std::int64_t since_ms, std::size_t limit) : since_ms_(since_ms), limit_(limit) {}

  /// Whether the next entry is shown.
  bool takes(const AuditEntry& entry) noexcept {
    if (is_full() || entry.time_ms < since_ms_)
      return false;
    ++taken_;
    return true;
  }
  /// Whether no further entry is shown.
  bool is_full() const noexcept { return limit_ > 0 && taken_ >= limit_; }

 private:
  const std::int64_t since_ms_;
  const std::size_t limit_;
  std::size_t taken_ = 0;
};

}  // namespace kinship::cli
