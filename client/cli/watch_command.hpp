#pragma once

#include <chrono>
#include <csignal>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

struct WatchOptions {
  std::string task;   ///< only events of this task; empty: all
  std::string robot;  ///< only events of this robot: label or digest prefix; empty: all
  bool json = false;  ///< one document per line, and nothing else on `out`
  /// Interval of the lines with rates and the benefit of guidance; 0: on a terminal in a status
  /// line, elsewhere never.
  std::chrono::seconds every{0};
  std::string place = {};  ///< "127.0.0.1, domain 0": the server's address
};

/// Blocks SIGINT and SIGTERM in this thread and those it starts from now on, so that
/// watch_events() takes them: to be called before there is a Client.
sigset_t block_end_signals();

/// `watch`: prints the server's events until SIGINT or SIGTERM; on `err`, that there is no server,
/// and each one that comes and goes. A robot name that cannot be looked up is used literally, with
/// a message on `err`: the robot may be registered later.
/// \param until  the result of block_end_signals().
int watch_events(link::Client& server, const WatchOptions& options, const sigset_t& until,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
