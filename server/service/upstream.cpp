#include "server/service/upstream.hpp"

#include <future>
#include <utility>

#include "server/service/fetch_service.hpp"
#include "server/service/report_service.hpp"
#include "server/service/validate_attempt.hpp"

namespace kinship::service {

void Upstream::start(ReportService& reports, FetchService& fetches) {
  const UpstreamOptions& upstream = parts_.options.upstream;
  if (!upstream.open)
    return;
  sites::ForwarderOptions forwarder;
  forwarder.open = upstream.open;
  forwarder.name = upstream.name;
  forwarder.niceness = parts_.options.fit_niceness;
  forwarder.exchange.clock = parts_.options.clock;
  forwarder.exchange.task_patterns = upstream.tasks;
  forwarder.exchange.log = [this](std::string_view line) {
    parts_.options.log("upstream: " + std::string(line));
  };
  forwarder.queued_reports = [&reports] { return reports.ingest().queued(); };
  forwarder.on_line = [this](std::string_view line) {
    parts_.tell({}, "upstream: " + std::string(line));
  };
  forwarder.hooks = hooks(reports, fetches);
  forwarder_ = std::make_unique<sites::Forwarder>(site_, std::move(forwarder));
}

sites::SiteHooks Upstream::hooks(ReportService& reports, FetchService& fetches) {
  sites::SiteHooks hooks;
  hooks.tasks_in_use = [this] { return used_tasks_.lately(parts_.options.clock.unix_ms()); };
  hooks.check = [this](const Attempt& attempt) -> std::optional<Error> {
    const Result<runtime::RobotRegistry::RobotPointer> robot = parts_.robots.find(attempt.robot);
    return robot ? validate(attempt, *robot.value()) : robot.error();
  };
  hooks.commit = [&reports](std::vector<store::ReplicatedReport> replicated,
                            store::ReportStore::ReportsDone done) {
    reports.commit_replicated(std::move(replicated), std::move(done));
  };
  hooks.take_geometry = [this](const Digest& robot, const RobotDescription& description) {
    if (!parts_.robots.offer_geometry(robot, description, parts_.options.clock.unix_ms()))
      return false;
    parts_.tell({}, "upstream: better geometry of robot " + robot.short_hex() + " came");
    return true;
  };
  hooks.on_retired = [this, &fetches](const Retirement& retirement) {
    fetches.forget_task(retirement.task);
    parts_.tell(retirement.task, std::to_string(retirement.paths) + " paths retired above");
  };
  return hooks;
}

void Upstream::stop() {
  if (!forwarder_)
    return;
  forwarder_->stop();
  // Its commits are answered when this one is: items are committed in turn.
  std::promise<void> answered;
  site_.commit_replicated({}, [&answered](const std::vector<Receipt>&) { answered.set_value(); });
  answered.get_future().wait();
}

void Upstream::wake() {
  if (forwarder_)
    forwarder_->wake();
}

void Upstream::note_task(const std::string& task) {
  if (forwarder_ && used_tasks_.note(task, parts_.options.clock.unix_ms()))
    forwarder_->wake_for_task();
}

std::optional<UpstreamStatus> Upstream::status(std::uint64_t attempts) const {
  return forwarder_ ? std::optional(forwarder_->status(attempts)) : std::nullopt;
}

void Upstream::expose(metrics::Exposition& page, std::uint64_t attempts) const {
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
  page.gauge("kinship_upstream_refused_reports", "Reports that were refused and are kept apart.",
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
