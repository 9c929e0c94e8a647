// A site's side of its exchange with the memory above it (server/sites).

#include <future>
#include <memory>
#include <utility>

#include "server/service/service.hpp"
#include "server/service/validate_attempt.hpp"

namespace kinship::service {

void Service::start_forwarder() {
  if (!options_.upstream.open)
    return;
  sites::ForwarderOptions forwarder;
  forwarder.open = options_.upstream.open;
  forwarder.name = options_.upstream.name;
  forwarder.niceness = options_.fit_niceness;
  forwarder.exchange.clock = options_.clock;
  forwarder.exchange.task_patterns = options_.upstream.tasks;
  forwarder.exchange.log = [this](std::string_view line) {
    options_.log("upstream: " + std::string(line));
  };
  forwarder.queued_reports = [this] { return ingest_.queued(); };
  forwarder.on_line = [this](std::string_view line) { tell_line(line); };
  forwarder.hooks.tasks_in_use = [this] { return used_tasks_.lately(options_.clock.unix_ms()); };
  forwarder.hooks.check = [this](const Attempt& attempt) -> std::optional<Error> {
    const Result<runtime::RobotRegistry::RobotPointer> robot = robots_.find(attempt.robot);
    return robot ? validate(attempt, *robot.value()) : robot.error();
  };
  forwarder.hooks.commit = [this](std::vector<store::ReplicatedReport> reports,
                                  store::Store::ReportsDone done) {
    commit_from_upstream(std::move(reports), std::move(done));
  };
  forwarder.hooks.take_geometry = [this](const Digest& robot, const RobotDescription& description) {
    if (!robots_.offer_geometry(robot, description, options_.clock.unix_ms()))
      return false;
    tell_line("better geometry of robot " + robot.short_hex() + " came");
    return true;
  };
  forwarder.hooks.on_retired = [this](const Retirement& retirement) {
    forget_task(retirement.task);
    const std::string what = std::to_string(retirement.paths) + " paths retired above";
    options_.log("task '" + retirement.task + "': " + what);
    events_.tell(EventKind::Administration, retirement.task, {}, [&] { return what; });
  };
  forwarder_ = std::make_unique<sites::Forwarder>(*store_, std::move(forwarder));
}

void Service::tell_line(std::string_view line) {
  options_.log("upstream: " + std::string(line));
  events_.tell(EventKind::Administration, "", {},
               [line] { return "upstream: " + std::string(line); });
}

void Service::commit_from_upstream(std::vector<store::ReplicatedReport> reports,
                                   store::Store::ReportsDone done) {
  std::vector<catalog::AttemptCost> costs;
  costs.reserve(reports.size());
  for (const store::ReplicatedReport& report : reports)
    costs.push_back(catalog::cost_of(report.attempt));
  store_->commit_replicated(std::move(reports),
                            [this, costs = std::move(costs),
                             done = std::move(done)](const std::vector<Receipt>& receipts) {
                              note_from_upstream(costs, receipts);
                              done(receipts);
                            });
}

/// As reports of this site's robots, but without an event for each of them.
void Service::note_from_upstream(std::span<const catalog::AttemptCost> costs,
                                 std::span<const Receipt> receipts) {
  std::map<std::string, std::size_t> grown;  // paths
  for (std::size_t i = 0; i < std::min(costs.size(), receipts.size()); ++i) {
    const bool is_stored = receipts[i].status == ReceiptStatus::Stored;
    if (is_stored || receipts[i].status == ReceiptStatus::Recorded) {
      advice_.add(costs[i]);
      known_tasks_.add(costs[i].task);
    }
    if (is_stored)
      ++grown[costs[i].task];
  }
  for (const auto& [task, paths] : grown) {
    new_experience(task);
    events_.tell(EventKind::Report, task, {},
                 [paths = paths] { return std::to_string(paths) + " paths of other sites came"; });
  }
}

void Service::stop_forwarder() {
  if (!forwarder_)
    return;
  forwarder_->stop();
  // Its commits are answered when this one is: items are committed in turn.
  std::promise<void> answered;
  store_->commit_replicated({}, [&answered](const std::vector<Receipt>&) { answered.set_value(); });
  answered.get_future().wait();
}

void Service::expose_upstream(metrics::Exposition& page, std::uint64_t attempts) const {
  if (!forwarder_)
    return;
  const UpstreamStatus upstream = forwarder_->status(attempts);
  constexpr double kMsPerS = 1000;
  page.gauge("kinship_upstream_connected", "1 while the memory above is connected, else 0.",
             std::uint64_t{upstream.connected});
  page.gauge("kinship_upstream_since_timestamp_seconds", "When it was connected, or went away.",
             static_cast<double>(upstream.since_ms) / kMsPerS);
  page.gauge("kinship_upstream_waiting_reports", "Reports that it was not yet asked about.",
             upstream.waiting);
  page.gauge("kinship_upstream_oldest_waiting_timestamp_seconds",
             "When the first of them came here; 0: none waits.",
             static_cast<double>(upstream.oldest_waiting_ms) / kMsPerS);
  page.gauge("kinship_upstream_refused_reports", "Reports that were refused and are set aside.",
             upstream.refused);
  page.gauge("kinship_upstream_tasks", "Tasks whose experience comes down.", upstream.tasks);
  page.counter("kinship_upstream_sent_total", "Reports that were new to it.", upstream.sent);
  page.counter("kinship_upstream_received_total", "Reports of other sites that were new here.",
               upstream.received);
  page.counter("kinship_upstream_left_out_total",
               "Reports that could not be read whole where they are.", upstream.left_out);
  page.counter("kinship_upstream_retired_above_total",
               "Paths retired above because they were retired here.", upstream.retired_above);
  page.counter("kinship_upstream_retired_here_total",
               "Paths retired here because they were retired above.", upstream.retired_here);
}

}  // namespace kinship::service
