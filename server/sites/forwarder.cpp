#include "server/sites/forwarder.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <exception>
#include <utility>
#include <vector>

namespace kinship::sites {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

class Forwarder::Connected {
 public:
  Connected(Forwarder& forwarder, store::Store& memory) : forwarder_(forwarder) { set(&memory); }
  Connected(const Connected&) = delete;
  Connected& operator=(const Connected&) = delete;
  ~Connected() { set(nullptr); }

 private:
  void set(store::Store* memory) {
    const std::lock_guard lock(forwarder_.mutex_);
    forwarder_.memory_ = memory;
  }

  Forwarder& forwarder_;
};

/// Saves the positions of an exchange, however it ends.
class Forwarder::Saved {
 public:
  explicit Saved(Exchange& exchange) : exchange_(exchange) {}
  Saved(const Saved&) = delete;
  Saved& operator=(const Saved&) = delete;
  ~Saved() {
    try {
      exchange_.save_positions();
    } catch (const std::exception&) {  // then it goes again
    }
  }

 private:
  Exchange& exchange_;
};

Forwarder::Forwarder(store::Store& site, ForwarderOptions options)
    : site_(site),
      options_(std::move(options)),
      backoff_(options_.first_retry, options_.longest_retry, options_.seed) {
  status_.name = options_.name;
  status_.since_ms = options_.exchange.clock.unix_ms();
  status_.message = "not connected yet";
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

Forwarder::~Forwarder() { stop(); }

void Forwarder::stop() {
  thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    if (memory_ != nullptr)
      memory_->stop_waiting();
  }
  if (thread_.joinable())
    thread_.join();
}

void Forwarder::wake() {
  const std::lock_guard lock(mutex_);
  is_woken_ = true;
  changed_.notify_all();
}

void Forwarder::wake_for_task() {
  const std::lock_guard lock(mutex_);
  has_new_task_ = true;
  is_woken_ = true;
  changed_.notify_all();
}

UpstreamStatus Forwarder::status(std::uint64_t attempts) const {
  const std::lock_guard lock(mutex_);
  UpstreamStatus status = status_;
  status.waiting = attempts > passed_ ? attempts - passed_ : 0;
  if (status.waiting == 0)
    status.oldest_waiting_ms = 0;
  return status;
}

/// As long, or until it is woken or to stop.
void Forwarder::wait(std::chrono::nanoseconds time, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, stop, time, [this] { return is_woken_; });
}

void Forwarder::run(const std::stop_token& stop) {
  // Linux keeps a nice value per thread; failing to lower it changes no result.
  if (options_.niceness > 0)
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), options_.niceness);
  while (!stop.stop_requested()) {
    try {
      exchange(stop);
    } catch (const std::exception& exception) {
      if (!stop.stop_requested())
        tell_line(false, exception.what());
    }
    wait_for_line(stop);
  }
}

/// Of a site that is cut off: which tasks it wants, whether or not it is restarted before the line
/// is back, and since when its reports wait.
void Forwarder::remember() {
  try {
    Positions positions(site_);
    positions.want(options_.hooks.tasks_in_use(), options_.exchange.clock.unix_ms());
    positions.save();
    note_oldest(positions);
    const std::lock_guard lock(mutex_);
    status_.tasks = positions.tasks.size();
  } catch (const std::exception&) {  // the store is at its end: its own status says so
  }
}

void Forwarder::wait_for_line(const std::stop_token& stop) {
  const auto until = Clock::now() + backoff_.next();
  do {
    remember();
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, until, [this] { return has_new_task_; });
    has_new_task_ = false;
  } while (!stop.stop_requested() && Clock::now() < until);
}

/// As long as the connection lasts. \throws the error that ends it.
void Forwarder::exchange(const std::stop_token& stop) {
  const std::unique_ptr<store::Store> memory = options_.open();
  const Connected connected(*this, *memory);
  if (stop.stop_requested())
    return;
  Positions positions(site_);
  ExchangeOptions exchange_options = options_.exchange;
  exchange_options.rest = [this, &positions](std::chrono::nanoseconds load,
                                             const std::stop_token& stopping) {
    publish(positions);
    rest(load, stopping);
  };
  Exchange exchange(site_, *memory, positions, counts_, options_.hooks, exchange_options);
  const Saved saved(exchange);
  tell_line(true, {});
  publish(positions);
  while (!stop.stop_requested()) {
    const Exchange::Step step = exchange.step(stop);
    backoff_.reset();
    publish(positions);
    if (step.has_worked) {
      note_oldest(positions);
      rest(step.load, stop);
    } else {
      wait(step.next - options_.exchange.clock.now(), stop);
    }
    const std::lock_guard lock(mutex_);
    if (std::exchange(is_woken_, false))
      exchange.look_up_now();
    if (std::exchange(has_new_task_, false))
      exchange.look_for_tasks_now();
  }
}

void Forwarder::tell_line(bool is_connected, const std::string& why) {
  bool is_new = false;
  {
    const std::lock_guard lock(mutex_);
    // A line that was never there is told once, too.
    is_new = is_connected != status_.connected || (!is_connected && status_.tries == 0);
    if (is_new)
      status_.since_ms = options_.exchange.clock.unix_ms();
    status_.connected = is_connected;
    status_.message = why;
    status_.tries = is_connected ? 0 : status_.tries + 1;
  }
  if (is_new)
    options_.on_line(is_connected ? "connected with " + options_.name
                                  : "no connection with " + options_.name + ": " + why);
}

void Forwarder::publish(const Positions& positions) {
  const std::lock_guard lock(mutex_);
  passed_ = positions.passed;
  status_.sent = counts_.sent;
  status_.received = counts_.received;
  status_.retired_above = counts_.retired_above;
  status_.retired_here = counts_.retired_here;
  status_.left_out = counts_.left_out;
  status_.refused = positions.refused_count() + counts_.passed_by;
  status_.tasks = positions.tasks.size();
  status_.first_refused.clear();
  for (const bool is_up : {false, true})
    if (!positions.refused(is_up).empty()) {
      const auto& [report, refused] = *positions.refused(is_up).begin();
      status_.first_refused = report.text() + ": " + refused.why;
    }
}

/// When the first report came that waits to be sent.
void Forwarder::note_oldest(const Positions& positions) {
  const std::vector<store::ArrivedReport> first = site_.list_arrivals("", positions.up, 1).rows;
  std::int64_t oldest_ms = 0;
  if (!first.empty()) {
    const Uuid report = first.front().report_uuid;
    const store::ReplicatedReports read = site_.read_reports(std::span(&report, 1), 1);
    if (!read.reports.empty())
      oldest_ms = read.reports.front().received_ms;
  }
  const std::lock_guard lock(mutex_);
  status_.oldest_waiting_ms = oldest_ms;
  passed_ = positions.passed;
}

/// In proportion to its load on this machine, and while reports of robots wait here; for them a
/// second at most, as a busy site would never send anything.
void Forwarder::rest(std::chrono::nanoseconds load, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook{20};
  constexpr std::chrono::seconds kLongest{1};
  const auto now = Clock::now();
  const auto rested = now + std::chrono::duration_cast<Clock::duration>(load * options_.rest);
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, stop, rested, [] { return false; });
  while (!stop.stop_requested() && Clock::now() < now + kLongest) {
    lock.unlock();
    if (options_.queued_reports() == 0)
      return;
    lock.lock();
    changed_.wait_for(lock, stop, kLook, [] { return false; });
  }
}

}  // namespace kinship::sites
