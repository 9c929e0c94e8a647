#include "client/cli/watch_command.hpp"

#include <algorithm>
#include <ostream>
#include <vector>

#include "client/cli/table.hpp"
#include "client/link/robot_names.hpp"
#include "proto/json/event_json.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {
namespace {

/// What events may call the robot that is watched; all of them if it is empty.
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

/// Texts come from whoever talks to the server: a terminal is not to obey them.
std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
  return text;
}

void print(const Event& event, bool json, std::ostream& out) {
  if (json) {
    out << json::to_json(event) << std::endl;  // a reader follows
    return;
  }
  out << time_text(event.time_ms) << "  " << to_text(event.kind);
  for (const std::string& part : {event.task, event.robot, event.text})
    if (!part.empty())
      out << "  " << printable(part);
  out << std::endl;
}

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
  const RobotNames robot = names_of(server, options.robot, err);
  const auto watcher =
      server.watch({.on_event =
                        [&](const Event& event) {
                          if (is_wanted(event, options.task, robot))
                            print(event, options.json, out);
                        },
                    .on_server = [&] { err << "watch: the server is there" << std::endl; },
                    .on_server_gone = [&] { err << "watch: the server has gone" << std::endl; }});
  int number = 0;
  sigwait(&until, &number);
  return kDone;
}

}  // namespace kinship::cli
