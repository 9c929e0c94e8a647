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
  bool json = false;  ///< one document a line, and nothing else on `out`
  /// Rates and what guidance brought as lines of their own, so often; 0: on a terminal in a line
  /// that is written again, elsewhere never.
  std::chrono::seconds every{0};
  std::string place = {};  ///< "127.0.0.1, domain 0": where the server is looked for
};

/// Blocks SIGINT and SIGTERM in this thread and those it starts from now on, so that
/// watch_events() takes them: to be called before there is a Client.
sigset_t block_end_signals();

/// `watch`: prints what happens at the server until SIGINT or SIGTERM; on `err`, that there is no
/// server, and each one that comes and goes. A robot that the server does not know, or without a
/// server, is taken by the letter, and `err` says so: it may be registered later. \param until what
/// block_end_signals() returned.
int watch_events(link::Client& server, const WatchOptions& options, const sigset_t& until,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
