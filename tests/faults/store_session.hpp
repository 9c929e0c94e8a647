#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/faults/simulated_disk.hpp"
#include "tests/faults/store_ledger.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// The disk after a power cut, and what had been acknowledged until then.
struct PowerCut {
  std::uint64_t change = 0;  ///< before which change of the disk it was
  DiskImage image;
  Receipts receipts;
};

/// A store on a simulated disk, used as a server uses it, with power cuts at random changes of the
/// disk. It runs on after each: a cut is an image of what the disk would have had.
class StoreSession {
 public:
  /// \param mean_gap  so many changes lie between two cuts in the mean.
  /// \param golden    a store of tests/golden to begin with, which is migrated to that of
  ///                  tests/support/next_schema.hpp; empty: none.
  StoreSession(std::uint64_t seed, std::uint64_t mean_gap,
               const std::filesystem::path& golden = {});

  /// From now on, beginning with the next change. Not while somebody uses the store.
  void cut_every(std::uint64_t mean_gap);
  /// From now on many of the next hundred changes after one that failed are cut too.
  void cut_often_after_failures() { is_eager_ = true; }

  SimulatedDisk& disk() { return disk_; }
  Ledger& ledger() { return ledger_; }
  std::filesystem::path file() const { return directory_ / kStoreName; }

  /// \param options  with a WAL so small that checkpoints come often, and tries 1 ms apart.
  std::unique_ptr<store::Store> open(const store::SqliteOptions& options = small_options()) const;
  static store::SqliteOptions small_options();

  void register_robots(store::Store& store);
  std::unique_ptr<store::Store> open_with_robots();
  /// By so many clients at once, each one to three attempts at a time.
  void report(store::Store& store, std::uint64_t clients, std::uint64_t attempts_of_each);
  void retire(store::Store& store, std::uint64_t number);
  void put_distribution(store::Store& store, std::uint64_t number);

  /// Looks at every cut so far, and at one now. \return what was lost, one line a cut.
  std::vector<std::string> find_losses();
  std::size_t cuts() const { return looked_at_; }  ///< that find_losses() saw

 private:
  void before_change(std::uint64_t change);
  void cut(std::uint64_t change);

  const TemporaryDirectory directory_;
  std::mt19937_64 generator_;
  std::uint64_t mean_gap_;
  std::uint64_t next_cut_ = 0;
  bool is_eager_ = false;
  std::uint64_t dense_until_ = 0;  // change
  std::uint64_t failed_ = 0;       // calls of the disk that had failed at the last change
  std::uint64_t next_number_ = 0;
  Ledger ledger_;
  std::vector<PowerCut> cuts_;
  std::size_t looked_at_ = 0;
  SimulatedDisk disk_;
};

}  // namespace kinship::test
