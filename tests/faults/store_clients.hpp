#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/store/store.hpp"

namespace kinship::test {

/// The main function of a process that has a store open, as a server has, and clients of it: each
/// reports one number after the other, sends it again until it is answered, now and then sends what
/// was answered, and reads generations. Some numbers are those of all clients everywhere. What they
/// do goes into a history; a process that is started with the history of one that was killed goes
/// on as clients with an outbox do: what has no answer is sent again.
///
/// Prints a line with each answer. Ends on SIGTERM, when all that was begun is answered.
///
///   URL HISTORY CLIENTS FIRST any | synchronous
///
/// Its clients are FIRST, FIRST + 1, ...; synchronous: the store requires a standby.
int run_store_clients(const std::vector<std::string>& arguments);

}  // namespace kinship::test
