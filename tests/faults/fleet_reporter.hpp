#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"
#include "server/store/store.hpp"

/// A client process that reports as fast as it can and keeps a ledger of it.
namespace kinship::test {

/// The attempt of a number, always the same. An odd number's has another UUID and the content of
/// the even one before; of five contents one is unsolved.
Attempt numbered_attempt(const Digest& robot, std::uint64_t number);

bool is_solved(std::uint64_t number);

/// What clients wrote down. A process that is killed leaves what it has written.
struct ReportLedger {
  std::set<std::uint64_t> begun;     ///< report() was called
  std::set<std::uint64_t> accepted;  ///< it has returned

  void read(const std::filesystem::path& file);  ///< adds what the file says
};

/// What is wrong with a store in the end, as counts.
struct FleetAudit {
  std::size_t stored = 0;    ///< reports that clients began
  std::size_t lost = 0;      ///< accepted, and not there
  std::size_t wrong = 0;     ///< there, and not as reported
  std::size_t unknown = 0;   ///< there, and nobody's
  std::size_t repeated = 0;  ///< paths with the content of another one
  std::size_t pathless = 0;  ///< contents that were reported solved, without a path
};

FleetAudit audit_fleet(const store::Store& store, const Digest& panda, const ReportLedger& ledger);
/// Of these only `stored` may be other than 0.
void expect_nothing_wrong(const FleetAudit& audit);

/// The main function of the client process: registers the Panda and reports numbers upwards from
/// `first`, every eighth of the last ones once more, with pauses between them, until SIGTERM. Then
/// delivers what is pending and prints "pending N refused N".
///
///   DOMAIN OUTBOX LEDGER FIRST PAUSE_MS [CREDENTIALS]
int run_reporting_client(const std::vector<std::string>& arguments);

}  // namespace kinship::test
