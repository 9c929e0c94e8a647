#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/simulated_disk.hpp"
#include "tests/support/store_values.hpp"

/// What a client knows of its reports, and what a store must still have of them.
namespace kinship::test {

/// The robots of all sessions.
const std::vector<store::RobotRecord>& ledger_robots();

/// The attempt of a number, always the same: one of five unsolved, some with a scene, some long. No
/// two have equal waypoints.
const Attempt& ledger_attempt(std::uint64_t number);

/// What was acknowledged up to some moment.
struct Receipts {
  std::set<std::string> robots;           ///< labels
  std::set<std::uint64_t> reports;        ///< numbers of ledger_attempt()
  std::set<std::uint64_t> retired;        ///< of these: retired, or being retired
  std::set<std::uint64_t> distributions;  ///< numbers of make_distribution()
  std::set<std::string> backups;          ///< names of files
  bool golden = false;  ///< the store began as one of tests/golden, and is migrated
};

/// Shared by the clients of a session.
class Ledger {
 public:
  template <typename Note>
  void note(Note entry) {
    const std::lock_guard lock(mutex_);
    entry(receipts_);
  }
  Receipts receipts() const {
    const std::lock_guard lock(mutex_);
    return receipts_;
  }

 private:
  mutable std::mutex mutex_;
  Receipts receipts_;
};

/// Reports until every attempt has an answer that is not TryAgain, and notes those that are stored.
/// \param patience  so often is an attempt tried again.
/// \return the attempts that were not taken.
std::size_t report_until_answered(store::Store& store, Ledger& ledger,
                                  const std::vector<std::uint64_t>& numbers,
                                  int patience = 100'000);

/// Lays the image into a directory of its own, opens the store in it as a server would, and
/// compares: every receipt is kept, once and readable, a resent report is Duplicate, the store
/// takes new ones, and the full check finds nothing.
/// \return what is wrong; empty: nothing.
std::string find_loss(const DiskImage& image, const Receipts& receipts);

/// The same of an open store, without closing it.
std::string find_loss(store::Store& store, const Receipts& receipts);

inline constexpr const char* kStoreName = "s.db";

}  // namespace kinship::test
