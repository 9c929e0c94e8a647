#pragma once

#include <csignal>
#include <iosfwd>
#include <string>

#include "client/link/client.hpp"

namespace kinship::cli {

struct WatchOptions {
  std::string task;   ///< only events of this task; empty: all
  std::string robot;  ///< only events of this robot: label or digest prefix; empty: all
  bool json = false;  ///< one document a line
};

/// Blocks SIGINT and SIGTERM in this thread and those it starts from now on, so that
/// watch_events() takes them: to be called before there is a Client.
sigset_t block_end_signals();

/// `watch`: prints what happens at the server until SIGINT or SIGTERM; servers that come and go
/// are named on `err`. A robot that the server does not know, or without a server, is taken by the
/// letter, and `err` says so: it may be registered later.
/// \param until  what block_end_signals() returned.
int watch_events(link::Client& server, const WatchOptions& options, const sigset_t& until,
                 std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
