#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "tests/faults/fleet_reporter.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// Processes of a fleet that are disturbed at random, and what decides how.
namespace kinship::test {

/// Draws from one seed: the same seed gives the same disturbances, in the same order.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}

  std::size_t below(std::size_t count) { return generator_() % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }
  std::chrono::milliseconds time(std::chrono::milliseconds from, std::chrono::milliseconds to);

 private:
  std::mt19937_64 generator_;
};

/// The wall clock of processes that are started with it (jumping_clock.cpp); their steady clocks go
/// on.
class JumpingClock {
 public:
  /// \param file  that says how far it is ahead.
  explicit JumpingClock(std::filesystem::path file);
  void jump_to(std::chrono::seconds ahead) const;
  /// Starts a process with it.
  std::unique_ptr<Program> start(const std::string& name, const std::vector<std::string>& arguments,
                                 const std::filesystem::path& log) const;

 private:
  std::filesystem::path file_;
};

/// A process that is started anew whenever it has ended, as a service manager does.
class Supervised {
 public:
  Supervised(const JumpingClock& clock, std::string name, std::filesystem::path log,
             std::function<std::vector<std::string>()> arguments);

  void start();
  /// Starts it if it has ended by itself; an end by a signal is a crash and fails the test.
  void keep_up();
  void kill();  ///< SIGKILL; stays down
  void kill_and_start();
  int terminate();  ///< SIGTERM; stays down. \return exit code
  void freeze_for(std::chrono::milliseconds time) const;  ///< SIGSTOP
  Program& program() { return *program_; }
  std::filesystem::path log() const { return log_; }

 private:
  const JumpingClock& clock_;
  const std::string name_;
  const std::filesystem::path log_;
  const std::function<std::vector<std::string>()> arguments_;
  std::unique_ptr<Program> program_;
};

/// Clients that report to the servers of some domains, as processes with outboxes and ledgers.
class ChaosClients {
 public:
  struct Place {
    std::uint32_t domain = 0;
    std::filesystem::path credentials = {};
  };

  /// \param count  of clients, by turns at the places; the last two share an outbox.
  ChaosClients(std::filesystem::path folder, const JumpingClock& clock, std::vector<Place> places,
               std::size_t count);

  void start_all();
  void keep_up();
  Supervised& any(Dice& dice) { return *clients_[dice.below(clients_.size())]; }
  /// Delivers all that they reported. Expects that nothing was refused.
  void drain();
  ReportLedger ledger() const;

 private:
  std::vector<std::string> arguments_of(std::size_t client);

  const std::filesystem::path folder_;
  const std::vector<Place> places_;
  std::vector<std::unique_ptr<Supervised>> clients_;
  std::uint64_t lives_ = 0;  // a ledger each
};

/// A disturbance, whole: what it broke works again when it returns.
struct Nuisance {
  std::string name;
  std::function<void(Dice&)> happen;
};

/// Disturbs for a time, with pauses in which receipts come; tells what it does.
/// \param keep_up  called between any two.
void run_chaos(std::uint64_t seed, std::chrono::seconds time,
               const std::vector<Nuisance>& nuisances, const std::function<void()>& keep_up);

}  // namespace kinship::test
