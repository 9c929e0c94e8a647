#include "client/cli/watch_command.hpp"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <ostream>
#include <sstream>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/cli/value_text.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/robot_names.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/event_json.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::cli {
namespace {

/// The names that events may use for the watched robot; all robots if it is empty.
using RobotNames = std::vector<std::string>;

/// An event names a robot by its label, or by the short form of a digest that the server does not
/// know: so the server is asked once which robot is meant.
RobotNames names_of(link::Client& server, const std::string& robot, std::ostream& err) {
  if (robot.empty())
    return {};
  const Result<RobotSummary> summary = link::find_robot(server, robot);
  if (summary)
    return {summary->label, summary->robot.short_hex()};
  err << "watch: " << summary.error().message << ": only events that name it '" << robot
      << "' are shown" << std::endl;
  return {robot};
}

bool is_wanted(const Event& event, const std::string& task, const RobotNames& robot) {
  return (task.empty() || event.task == task) &&
         (robot.empty() || std::ranges::find(robot, event.robot) != robot.end());
}

/// Texts come from any client of the server: a terminal is not to obey them.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
  return text;
}

/// The colour of a kind of event on a terminal.
const char* colour_of(EventKind kind) {
  switch (kind) {
    case EventKind::Refusal:
      return "\033[31m";  // red
    case EventKind::Fit:
      return "\033[32m";  // green
    case EventKind::Registered:
    case EventKind::Administration:
      return "\033[33m";  // yellow
    default:
      return "";
  }
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

constexpr std::size_t kTime = 20, kKind = 10, kName = 14;  // columns of text

std::string line_of(const Event& event, bool is_coloured) {
  const char* const colour = is_coloured ? colour_of(event.kind) : "";
  return padded(time_text(event.time_ms), kTime) + "  " + colour +
         padded(std::string(to_text(event.kind)), kKind) + (*colour == '\0' ? "" : "\033[0m") +
         "  " + padded(printable(event.task.empty() ? "-" : event.task), kName) + "  " +
         padded(printable(event.robot.empty() ? "-" : event.robot), kName) + "  " +
         printable(event.text);
}

/// The screen, written by the thread of the watcher and by the one that waits.
class Watch {
 public:
  Watch(link::Client& server, const WatchOptions& options, std::ostream& out, std::ostream& err)
      : server_(server),
        options_(options),
        out_(out),
        err_(err),
        is_coloured_(may_colour(out)),
        has_status_line_(is_terminal(err) && is_terminal(out) && !options.json),
        line_(err, has_status_line_) {
    if (!options_.json)
      out_ << padded("TIME", kTime) << "  " << padded("KIND", kKind) << "  "
           << padded("TASK", kName) << "  " << padded("ROBOT", kName) << "  WHAT" << std::endl;
  }

  link::Watcher::Handlers handlers() {
    return {.on_event = [this](const Event& event) { tell(event); },
            .on_server = [this] { greet(); },
            .on_server_gone = [this] { note_gone(); }};
  }

  /// Called once a second.
  void tick() {
    if (!is_there_) {
      if (!has_said_so_.exchange(true))
        say("no server at " + options_.place + " yet; waiting for one");
      return;
    }
    if (!has_status_line_ && options_.every.count() == 0)
      return;
    read_rates();
    if (options_.every.count() > 0 && ++ticks_ % options_.every.count() == 0)
      tell_rates();
  }

 private:
  void tell(const Event& event) {
    const std::lock_guard lock(mutex_);
    if (!is_wanted(event, options_.task, robot_))
      return;
    line_.clear();
    if (options_.json)
      out_ << json::to_json(event) << std::endl;  // a reader follows
    else
      out_ << line_of(event, is_coloured_) << std::endl;
    line_.show(status_);
  }

  void say(const std::string& what) {
    const std::lock_guard lock(mutex_);
    line_.clear();
    err_ << "watch: " << what << std::endl;
  }

  /// A robot may be registered later, and a server come later: it is asked when it is there.
  void greet() {
    std::ostringstream trouble;
    const RobotNames robot = names_of(server_, options_.robot, trouble);
    {
      const std::lock_guard lock(mutex_);
      robot_ = robot;
      line_.clear();
      err_ << trouble.str();
    }
    say("the server is there: " + options_.place);
    has_said_so_ = true;
    is_there_ = true;
  }

  void note_gone() {
    is_there_ = false;
    {
      const std::lock_guard lock(mutex_);
      status_.clear();
    }
    say("the server has gone; waiting for it");
  }

  RobotNames robot() {
    const std::lock_guard lock(mutex_);
    return robot_;
  }

  void read_rates() {
    // That the server goes is said when it has gone.
    const auto status = link::row_of<ServerStatus>(server_, {.verb = AdminVerb::Status});
    if (!status)
      return;
    rates_.add(*status, std::chrono::steady_clock::now());
    constexpr int kGuidanceEvery = 5;  // ticks: it changes with reports alone, and is asked of all
    if (readings_++ % kGuidanceEvery == 0)
      read_guidance();
    const std::lock_guard lock(mutex_);
    status_ = rates_.text() + (guidance_.empty() ? "" : "; " + guidance_.back());
    line_.show(status_);
  }

  /// Robots and tasks whose evidence changed since the last reading; at first, all wanted ones.
  void read_guidance() {
    struct Change {
      std::string task, robot, text;
    };
    std::vector<Change> changed;
    const RobotNames wanted = robot();
    const auto take = [&](const std::string& row) {
      const auto task = json::row_from_json<TaskSummary>(row);
      if (!task || (!options_.task.empty() && task->task != options_.task))
        return true;
      for (const TaskRobotSummary& robot : task->robots) {
        if (!wanted.empty() && std::ranges::find(wanted, robot.label) == wanted.end())
          continue;
        std::string text = printable(guidance_text(task->task, robot));
        std::string& known = known_guidance_[{task->task, robot.label}];
        if (!text.empty() && text != known)
          changed.push_back({task->task, robot.label, known = std::move(text)});
      }
      return true;
    };
    static_cast<void>(link::for_each_row(server_, {.verb = AdminVerb::ListTasks}, take));
    if (!changed.empty())
      guidance_.clear();
    for (const Change& change : changed)
      guidance_.push_back(change.text + printable(worth_of(change.task, change.robot)));
  }

  /// Of a robot's experience, by rehearsal with its newest distribution; empty: not rehearsed.
  std::string worth_of(const std::string& task, const std::string& robot) {
    const auto newest = link::row_of<DistributionSummary>(
        server_, {.verb = AdminVerb::ListDistributions, .robot = robot, .task = task, .limit = 1});
    if (!newest)
      return {};
    const auto explained = link::row_of<Explanation>(
        server_, {.verb = AdminVerb::ExplainDistribution, .argument = newest->id.hex()});
    const auto value =
        explained && explained->rehearsal ? worth(*explained->rehearsal) : std::nullopt;
    return value ? "; worth of its experience " + worth_text(*value) : std::string();
  }

  void tell_rates() {
    const std::lock_guard lock(mutex_);
    line_.clear();
    const std::string now = padded(time_text(now_ms()), kTime) + "  ";
    if (const std::string rates = rates_.text(); !rates.empty())
      out_ << now << padded("rates", kKind) << "  " << rates << std::endl;
    for (const std::string& guidance : std::exchange(guidance_, {}))
      out_ << now << padded("guidance", kKind) << "  " << guidance << std::endl;
  }

  link::Client& server_;
  const WatchOptions& options_;
  std::ostream& out_;
  std::ostream& err_;
  const bool is_coloured_, has_status_line_;
  std::atomic<bool> is_there_ = false, has_said_so_ = false;

  std::mutex mutex_;  // guards the streams and the data of both threads:
  StatusLine line_;
  std::string status_;
  RobotNames robot_;

  // Of the thread that waits.
  ServerRates rates_{std::chrono::seconds(10)};
  std::int64_t ticks_ = 0;
  int readings_ = 0;
  std::vector<std::string> guidance_;
  std::map<std::pair<std::string, std::string>, std::string> known_guidance_;
};

}  // namespace

sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

int watch_events(link::Client& server, const WatchOptions& options, const sigset_t& until,
                 std::ostream& out, std::ostream& err) {
  Watch watch(server, options, out, err);
  const auto watcher = server.watch(watch.handlers());
  constexpr timespec kTick{1, 0};
  while (sigtimedwait(&until, nullptr, &kTick) < 0)
    watch.tick();
  return kDone;
}

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
         " uniform: " + number_text(ratio, kDigits) + " times " + (is_worth_it ? "fewer" : "more") +
         (robot.guided_means ? "; guided: " + means_text(*robot.guided_means) : "") +
         (robot.control_means ? "; uniform: " + means_text(*robot.control_means) : "");
}

}  // namespace kinship::cli
