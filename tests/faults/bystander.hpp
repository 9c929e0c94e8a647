#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "client/link/client.hpp"

namespace kinship::test {

/// A robot of the fleet that does what robots do, beside whatever else happens to the server.
class Bystander {
 public:
  /// Registers the Panda, reports of task "sweep" and fetches its distribution, so that the server
  /// has that in memory.
  Bystander(std::uint32_t domain, const std::filesystem::path& outbox);

  /// What the calls of one kind took.
  struct Calls {
    std::vector<double> times_s;
    std::size_t unanswered = 0;  ///< within 20 s, or not with what was asked for
    std::string answer;          ///< the last of those
  };
  struct Rounds {
    Calls status, fetch, report;

    std::size_t unanswered() const {
      return status.unanswered + fetch.unanswered + report.unanswered;
    }
    std::string answers() const { return status.answer + fetch.answer + report.answer; }
  };

  /// Asks for the server's status, for the distribution in memory, and hands over a report until it
  /// is durable; `rounds` times, or until nobody answers.
  Rounds live(int rounds);

  const Digest& panda() const noexcept { return panda_; }
  link::Client& client() noexcept { return client_; }

 private:
  link::Client client_;
  Digest panda_;
  std::uint64_t reports_ = 0;
};

/// One line: median and longest time of each kind of call, alone and beside somebody.
std::string table_row(const std::string& beside_whom, const Bystander::Rounds& alone,
                      const Bystander::Rounds& beside);

}  // namespace kinship::test
