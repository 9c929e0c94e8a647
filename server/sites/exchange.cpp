#include "server/sites/exchange.hpp"

#include <algorithm>
#include <ctime>
#include <random>
#include <set>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/sites/carry_robot.hpp"
#include "server/sites/wanted_tasks.hpp"

namespace kinship::sites {
namespace {

/// Of this thread: waiting for the memory does not count.
std::chrono::nanoseconds processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

std::string text_of(const RefusedReport& report, bool is_up) {
  return "report " + report.report_uuid.text() + (is_up ? " is refused above: " : " from above: ") +
         report.why;
}

}  // namespace

Exchange::Exchange(store::Store& site, store::Store& memory, Positions& positions,
                   ExchangeCounts& counts, SiteHooks hooks, ExchangeOptions options)
    : site_(site),
      memory_(memory),
      positions_(positions),
      counts_(counts),
      hooks_(std::move(hooks)),
      options_(std::move(options)),
      geometry_(site, memory,
                hooks_.take_geometry ? hooks_.take_geometry : take_with_registry(site),
                take_with_registry(memory)),
      refused_backoff_(options_.first_refused_retry, options_.longest_refused_retry,
                       std::random_device()()) {
  begin();
}

/// Tells a memory that it lost acknowledged reports, as clients tell a server.
void Exchange::begin() {
  if (memory_.has_lost(positions_.token) && memory_.begin_epoch_if_lost(positions_.token))
    options_.log("the memory above was rolled back behind what it acknowledged");
  if (!positions_.begin(site_.epoch(), memory_.epoch()))
    return;
  options_.log("everything is compared with the memory above, from the beginning");
  up_due_ = tasks_due_ = {};
  down_due_.clear();
}

TakeGeometry Exchange::take_with_registry(store::RobotStore& store) const {
  return [this, &store](const Digest& robot, const RobotDescription& description) {
    return runtime::RobotRegistry(store).offer_geometry(robot, description,
                                                        options_.clock.unix_ms());
  };
}

/// Over the line once a connection: if it is removed above meanwhile, its next report says so, and
/// ends the connection.
std::optional<Error> Exchange::bring_robot(store::RobotStore& from, store::RobotStore& to,
                                           const Digest& robot) {
  if (robots_of_both_.contains(robot) && site_.find_robot(robot))
    return std::nullopt;
  if (std::optional<Error> error = carry_robot(from, to, robot))
    return error;
  robots_of_both_.insert(robot);
  geometry_.compare_new(robot);
  return std::nullopt;
}

/// Processor time of this thread and time of commits here since the last call.
std::chrono::nanoseconds Exchange::take_load() {
  const std::chrono::nanoseconds now = processor_time();
  return now - std::exchange(processor_before_, now) +
         std::chrono::nanoseconds(commits_ns_->exchange(0));
}

/// After the last one the caller of step() rests. Retirements carried by now need not be carried
/// again after a restart.
void Exchange::rest_before_write(const std::stop_token& stop) {
  if (!std::exchange(has_written_, true))
    return;
  save_if_due();
  options_.rest(take_load(), stop);
}

void Exchange::save_positions() {
  positions_.save();
  save_due_ = options_.clock.now() + options_.save_every;
}

void Exchange::save_if_due() {
  if (save_due_ <= options_.clock.now())
    save_positions();
}

Way Exchange::way_up(const std::stop_token& stop) {
  return {.from = site_,
          .to = memory_,
          .bring_robot = [this](const Digest& robot) { return bring_robot(site_, memory_, robot); },
          .on_retired =
              [this](const Retirement& retirement) { counts_.retired_above += retirement.paths; },
          .before_write = [this, stop] { rest_before_write(stop); },
          .stop = stop};
}

Way Exchange::way_down(const std::stop_token& stop) {
  return {.from = memory_,
          .to = site_,
          .bring_robot = [this](const Digest& robot) { return bring_robot(memory_, site_, robot); },
          .commit =
              [this](std::vector<store::ReplicatedReport> reports, store::Store::ReportsDone done) {
                commit_here(std::move(reports), std::move(done));
              },
          .retire = [this](std::span<const Uuid> reports) { return retire_here(reports); },
          .check = hooks_.check,
          .on_retired =
              [this](const Retirement& retirement) {
                counts_.retired_here += retirement.paths;
                hooks_.on_retired(retirement);
              },
          .before_write = [this, stop] { rest_before_write(stop); },
          .stop = stop};
}

void Exchange::commit_here(std::vector<store::ReplicatedReport> reports,
                           store::Store::ReportsDone done) {
  const auto timed = [total = commits_ns_, began = std::chrono::steady_clock::now(),
                      done = std::move(done)](const std::vector<Receipt>& receipts) {
    *total += std::chrono::nanoseconds(std::chrono::steady_clock::now() - began).count();
    done(receipts);
  };
  if (hooks_.commit)
    hooks_.commit(std::move(reports), timed);
  else
    site_.commit_replicated(std::move(reports), timed);
}

std::vector<Retirement> Exchange::retire_here(std::span<const Uuid> reports) {
  const auto began = std::chrono::steady_clock::now();
  std::vector<Retirement> retired = site_.retire_reports(reports);
  *commits_ns_ += std::chrono::nanoseconds(std::chrono::steady_clock::now() - began).count();
  return retired;
}

/// Notes the refused reports. Beyond kMaxRefused those that break a rule are passed by, as nothing
/// will make them good; those that are put off would be lost: the exchange waits.
std::uint64_t Exchange::take(const CarriedReports& carried, bool is_up) {
  std::uint64_t passed_by = 0;
  for (const RefusedReport& report : carried.refused) {
    const auto before = positions_.refused(is_up).find(report.report_uuid);
    const bool is_told =
        before != positions_.refused(is_up).end() && before->second.why == report.why;
    const bool is_kept = positions_.refuse(report, is_up);
    if (!is_kept && report.is_put_off)
      throw Failure(
          ErrorCode::Unavailable,
          std::to_string(Positions::kMaxRefused) +
              " reports are put off: no more are carried before some of them are taken; " +
              text_of(report, is_up));
    if (!is_told)
      options_.log(text_of(report, is_up) + (is_kept ? "" : "; it is not tried again"));
    passed_by += is_kept ? 0 : 1;
  }
  counts_.left_out += carried.left_out;
  counts_.passed_by += passed_by;
  return carried.new_there;
}

/// With each connection and, less and less often, while it lasts.
void Exchange::try_refused_again(const std::stop_token& stop) {
  bool is_any_taken = positions_.refused_count() == 0;
  for (const bool is_up : {true, false}) {
    std::vector<Uuid> reports;
    for (const auto& [report, refused] : positions_.refused(is_up))
      reports.push_back(report);
    if (reports.empty())
      continue;
    const CarriedReports carried =
        is_up ? carry_reports(way_up(stop), reports, positions_.up_retired, options_.up)
              : carry_reports(way_down(stop), reports, positions_.down_retired, options_.down);
    std::set<Uuid> again;
    for (const RefusedReport& report : carried.refused)
      again.insert(report.report_uuid);
    for (const Uuid& report : reports)
      if (!again.contains(report))
        positions_.accept(report, is_up);
    is_any_taken = is_any_taken || again.size() < reports.size();
    (is_up ? counts_.sent : counts_.received) += take(carried, is_up);
  }
  if (is_any_taken)
    refused_backoff_.reset();
  refused_due_ = options_.clock.now() + refused_backoff_.next();
  save_positions();
}

void Exchange::want_tasks() {
  const std::int64_t now_ms = options_.clock.unix_ms();
  std::set<std::string> wanted = hooks_.tasks_in_use();
  if (!options_.task_patterns.empty()) {
    store::Page<TaskSummary> page;
    do {
      page = memory_.list_tasks(page.next_cursor, kMaxPageRows);
      for (const TaskSummary& task : page.rows)
        if (matches_any(options_.task_patterns, task.task))
          wanted.insert(task.task);
    } while (!page.next_cursor.empty());
  }
  positions_.want(wanted, now_ms);
  const std::int64_t use_ms = std::chrono::milliseconds(options_.task_use).count();
  std::map<std::string, TimePoint> due;
  for (const auto& [task, position] : positions_.tasks)
    if (now_ms - position.used_ms <= use_ms) {
      const auto known = down_due_.find(task);
      due[task] = known == down_due_.end() ? TimePoint() : known->second;
    }
  down_due_ = std::move(due);
}

bool Exchange::carry_up(const std::stop_token& stop) {
  const CarriedPage page =
      carry_page(way_up(stop), "", positions_.up, positions_.up_retired, options_.up);
  counts_.sent += take(page.reports, true);
  positions_.up = page.cursor;
  positions_.passed += page.looked_at;
  if (page.reports.new_there > 0)
    positions_.token = memory_.point().token;
  up_due_ = page.has_more ? TimePoint() : look_again();
  return page.looked_at > 0;
}

bool Exchange::carry_down(const std::string& task, const std::stop_token& stop) {
  Positions::Task& position = positions_.tasks[task];
  const CarriedPage page =
      carry_page(way_down(stop), task, position.cursor, positions_.down_retired, options_.down);
  counts_.received += take(page.reports, false);
  position.cursor = page.cursor;
  down_due_[task] = page.has_more ? TimePoint() : look_again();
  return page.looked_at > 0;
}

Exchange::Step Exchange::step(const std::stop_token& stop) {
  take_load();
  has_written_ = false;
  begin();
  const TimePoint now = options_.clock.now();
  Step step;
  if (refused_due_ <= now)
    try_refused_again(stop);
  if (tasks_due_ <= now) {
    want_tasks();
    geometry_.compare_changed();
    // Also where no task is wanted: reports that this site sent may be retired above.
    step.has_worked = carry_retirements(way_down(stop), positions_.down_retired, options_.down) > 0;
    save_positions();
    tasks_due_ = look_again();
  }
  const auto is_due = [now](const auto& entry) { return entry.second <= now; };
  // In turns: up, one task, up, the next task.
  auto down = std::find_if(down_due_.upper_bound(last_), down_due_.end(), is_due);
  if (down == down_due_.end())
    down = std::ranges::find_if(down_due_, is_due);
  const bool is_up = up_due_ <= now && (is_ups_turn_ || down == down_due_.end());
  if (is_up) {
    step.has_worked |= carry_up(stop);
  } else if (down != down_due_.end()) {
    last_ = down->first;
    step.has_worked |= carry_down(std::string(last_), stop);
  }
  is_ups_turn_ = !is_up;
  save_if_due();
  step.next = std::min(up_due_, tasks_due_);
  if (positions_.has_changed())
    step.next = std::min(step.next, save_due_);
  if (positions_.refused_count() > 0)
    step.next = std::min(step.next, refused_due_);
  for (const auto& [task, due] : down_due_)
    step.next = std::min(step.next, due);
  step.load = take_load();
  return step;
}

}  // namespace kinship::sites
