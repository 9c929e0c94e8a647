#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "proto/types/attempt.hpp"

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

/// The main function of the client process: registers the Panda and reports numbers upwards from
/// `first`, every eighth of the last ones once more, until SIGTERM. Then delivers what is pending
/// and prints "pending N refused N".
///
///   DOMAIN OUTBOX LEDGER FIRST
int run_reporting_client(const std::vector<std::string>& arguments);

}  // namespace kinship::test
