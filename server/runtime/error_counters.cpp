#include "server/runtime/error_counters.hpp"

#include <optional>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::runtime {

void ErrorCounters::add(Trouble what, std::string_view detail, std::uint64_t count) {
  if (count == 0)
    return;
  const auto kind = static_cast<std::size_t>(what);
  const std::chrono::steady_clock::time_point now = clock_.now();
  std::string line;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_.at(kind);
    if (entry.count == 0 || now - entry.last_time >= kQuiet) {
      const std::uint64_t unsaid = entry.count - entry.logged_at;
      line = std::string(kTroubleNames.at(kind)) + ": " + std::string(detail) +
             (unsaid > 0 ? " (" + std::to_string(unsaid) + " more since the last such line)" : "");
      entry.logged_at = entry.count + count;
    }
    entry.count += count;
    entry.last = cut_text(std::string(detail), kMaxMessageBytes);
    entry.last_ms = clock_.unix_ms();
    entry.last_time = now;
  }
  if (!line.empty())
    log_(line);
}

std::vector<TroubleCount> ErrorCounters::counts() const {
  std::vector<TroubleCount> counts;
  const std::lock_guard lock(mutex_);
  for (std::size_t kind = 0; kind < entries_.size(); ++kind)
    if (const Entry& entry = entries_.at(kind); entry.count > 0)
      counts.push_back(
          {std::string(kTroubleNames.at(kind)), entry.count, entry.last, entry.last_ms});
  return counts;
}

}  // namespace kinship::runtime
