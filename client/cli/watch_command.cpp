#include "client/cli/watch_command.hpp"

#include <algorithm>
#include <ostream>

#include "client/cli/exit_code.hpp"
#include "client/cli/table.hpp"
#include "proto/json/event_json.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::cli {
namespace {

bool is_wanted(const Event& event, const WatchOptions& options) {
  return (options.task.empty() || event.task == options.task) &&
         (options.robot.empty() || event.robot == options.robot);
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
  const auto watcher =
      server.watch({.on_event =
                        [&](const Event& event) {
                          if (is_wanted(event, options))
                            print(event, options.json, out);
                        },
                    .on_server = [&] { err << "watch: the server is there" << std::endl; },
                    .on_server_gone = [&] { err << "watch: the server has gone" << std::endl; }});
  int number = 0;
  sigwait(&until, &number);
  return kDone;
}

}  // namespace kinship::cli
