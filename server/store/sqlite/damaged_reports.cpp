#include "server/store/sqlite/damaged_reports.hpp"

namespace kinship::store {

void DamagedReports::note(const Uuid& report_uuid, const std::string& why, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (reports_.size() >= kMaxReports)
    reports_.clear();
  reports_[report_uuid] = {why, now + kRemembered};
}

std::optional<std::string> DamagedReports::find(const Uuid& report_uuid, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto found = reports_.find(report_uuid);
  if (found == reports_.end())
    return std::nullopt;
  if (now < found->second.until)
    return found->second.why;
  reports_.erase(found);
  return std::nullopt;
}

}  // namespace kinship::store
