#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/faults/report_history.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// Processes with a store each and clients of it, see run_store_clients(); any may be killed and
/// started again. For the test's main thread.
class StoreFleet {
 public:
  struct Options {
    std::size_t servers = 1;
    std::uint32_t clients = 1;      ///< of each
    bool requires_standby = false;  ///< the stores acknowledge nothing without a synchronous one
  };

  explicit StoreFleet(const Options& options);
  ~StoreFleet();

  std::size_t size() const noexcept { return servers_.size(); }
  void start(std::size_t server, const std::string& store);
  void start_all(const std::string& store);
  void kill(std::size_t server);

  /// Returns after so many more answers; the random instant of a fault is a random number of them.
  /// \return whether they came within `patience`.
  bool wait_for_answers(std::uint64_t more,
                        std::chrono::milliseconds patience = std::chrono::minutes(2));
  std::uint64_t answers() const;

  /// All finish what they have begun and end. \return whether each did, within two minutes.
  bool end();

  std::vector<HistoryEntry> history() const;
  std::string log() const;  ///< what the processes said, the end of it

 private:
  struct Server {
    std::unique_ptr<Program> process;
    std::thread listener;
  };

  void listen(Program& process);
  std::filesystem::path history_file(std::size_t server) const;

  Options options_;
  TemporaryDirectory folder_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t answers_ = 0;  // guarded by mutex_
  std::size_t running_ = 0;    // guarded by mutex_
  std::vector<Server> servers_;
};

}  // namespace kinship::test
