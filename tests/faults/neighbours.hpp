#pragma once

#include <string>
#include <vector>

namespace kinship::test {

/// The main function of a bad neighbour's process: KIND DOMAIN. Prints "ready" once it is
/// one. The kinds:
///
/// - report, fetch, admin, register: sends requests of that conversation as fast as it can, each
///   another one, and never reads a reply;
/// - stopped: watches, follows, and has a fetch under way that waits for a minute;
/// - long-paths: reports paths of 16 384 waypoints, a million waypoints in all;
/// - many-tasks: reports attempts of ten thousand tasks;
/// - long-leases: takes 4096 leases of 24 h.
///
/// Those that come to an end print "done N", N of what was accepted, the others live until they are
/// killed.
int run_neighbour(const std::vector<std::string>& arguments);

}  // namespace kinship::test
