#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/types/summaries.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"

namespace kinship::test {

/// A DDS domain of its own with a kinshipd, as a process that a test may kill, and one client.
/// What it reports and fetches is of the task "sweep".
class Cell {
 public:
  /// How long a test waits for what is sure to come: the machine may have other work.
  static constexpr std::chrono::seconds kEnough{120};

  struct Options {
    std::filesystem::path folder;             ///< of log and outbox; made if it is not there
    std::string store = {};                   ///< file, or URL; empty: fleet.db in the folder
    std::vector<std::string> arguments = {};  ///< of kinshipd, further ones
  };

  /// The client alone. \throws Failure
  explicit Cell(Options options);

  /// The server; returns when it serves. \throws std::runtime_error with its log if it does not.
  void start();
  ServerProcess& server() { return *server_; }
  void kill() { server_->kill(); }
  int terminate() { return server_->terminate(); }
  void signal(int number) const { server_->signal(number); }
  std::string log() const { return read_text(options_.folder / "log"); }

  link::Client& client() { return client_; }
  std::uint32_t domain() const { return domain_.number(); }
  /// A program of the client from its start to its end, told domain and time limit.
  /// \param line  its further words, see words().
  Answer run(const std::string& program, const std::string& line) const;
  Answer kinship(const std::string& line) const { return run("kinship", line); }

  RegisterReply register_model(const std::string& model);
  /// So many sweeps of a Panda, durable on return.
  /// \param first  seed of the first; those after it have the next ones.
  std::vector<Uuid> report(const Digest& panda, std::uint64_t first, std::uint64_t count);
  /// Waits for half a minute at most, see link::Client.
  FetchReply fetch(const Digest& robot, std::uint64_t minimum_generation = 0);
  AdminReply ask(AdminRequest request) { return client_.admin(request).value_or_throw(); }
  AdminReply ask(AdminVerb verb, const std::string& argument);
  ServerStatus status();

 private:
  const Options options_;
  const ReservedDomain domain_;
  std::unique_ptr<ServerProcess> server_;
  link::Client client_;
};

}  // namespace kinship::test
