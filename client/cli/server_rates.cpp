#include "client/cli/server_rates.hpp"

#include "client/cli/cell_text.hpp"

namespace kinship::cli {

void ServerRates::add(const ServerStatus& status, TimePoint now) {
  if (!readings_.empty()) {
    const ServerStatus& last = readings_.back().status;
    if (status.uptime_s < last.uptime_s || status.reports_received < last.reports_received ||
        status.fetches < last.fetches || status.fits < last.fits)
      readings_.clear();
  }
  readings_.push_back({now, status});
  while (readings_.size() > 2 && now - readings_[1].time >= window_)
    readings_.pop_front();
}

std::string ServerRates::text() const {
  if (readings_.size() < 2)
    return {};
  const Reading& first = readings_.front();
  const Reading& last = readings_.back();
  const double seconds = std::chrono::duration<double>(last.time - first.time).count();
  const auto rate = [&](std::uint64_t ServerStatus::*counter) {
    const std::uint64_t more = last.status.*counter - first.status.*counter;
    return number_text(seconds > 0 ? static_cast<double>(more) / seconds : 0, 1) + "/s";
  };
  std::string text = "reports " + rate(&ServerStatus::reports_received) + ", fetches " +
                     rate(&ServerStatus::fetches) + ", fits " + rate(&ServerStatus::fits);
  if (last.status.queued_reports > 0 || last.status.queued_fits > 0)
    text += "; queued " + count_text(last.status.queued_reports, "report") + ", " +
            count_text(last.status.queued_fits, "fit");
  return text;
}

std::string guidance_text(const std::string& task, const TaskRobotSummary& robot) {
  const auto& guided = robot.guided;
  const auto& control = robot.control;
  if (!guided || !control || guided->checks_per_solution <= 0 || control->checks_per_solution <= 0)
    return {};
  constexpr int kDigits = 2;
  const bool is_worth_it = guided->checks_per_solution <= control->checks_per_solution;
  const double ratio = is_worth_it ? control->checks_per_solution / guided->checks_per_solution
                                   : guided->checks_per_solution / control->checks_per_solution;
  return robot.label + " on " + task + ": " + number_text(guided->checks_per_solution, 0) +
         " checks a solution guided, " + number_text(control->checks_per_solution, 0) +
         " uniform: " + number_text(ratio, kDigits) + " times " + (is_worth_it ? "fewer" : "more");
}

}  // namespace kinship::cli
