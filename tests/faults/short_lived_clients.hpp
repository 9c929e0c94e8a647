#pragma once

#include <string>
#include <vector>

namespace kinship::test {

/// The main function of a process of clients, each with a participant of its own: each asks for the
/// server's status and for the Panda's distribution of task "sweep", every fifth follows it. Prints
/// "answered N". Then they end, or the process kills itself.
///
///   DOMAIN CLIENTS end|die
int run_short_lived_clients(const std::vector<std::string>& arguments);

}  // namespace kinship::test
