#include "server/store/values/put_off_reports.hpp"

namespace kinship::store {

void PutOffReports::note(const Uuid& report_uuid, const std::string& why, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (reports_.size() >= kMaxReports)
    reports_.clear();
  reports_[report_uuid] = {why, now + remembered_};
  ++count_;
  last_ = why;
}

std::optional<std::string> PutOffReports::find(const Uuid& report_uuid, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto found = reports_.find(report_uuid);
  if (found == reports_.end())
    return std::nullopt;
  if (now < found->second.until)
    return found->second.why;
  reports_.erase(found);
  return std::nullopt;
}

std::string PutOffReports::told() const {
  const std::lock_guard lock(mutex_);
  if (count_ == 0)
    return "";
  return "reports were put off " + std::to_string(count_) + (count_ == 1 ? " time" : " times") +
         " since the start, the last: " + last_;
}

}  // namespace kinship::store
