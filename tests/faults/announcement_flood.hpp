#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "tests/faults/captured_packets.hpp"

namespace kinship::test {

/// The announcement (SPDP) in captured packets of a client, with a lease of 68 years.
/// \throws std::runtime_error if there is none.
Packet endless_announcement(const std::vector<Packet>& packets);

/// Announces participants that are not there to a server of this machine, from its construction to
/// its end.
class AnnouncementFlood {
 public:
  struct Options {
    std::uint32_t domain = 0;
    Packet announcement;  ///< each time of another participant
    double per_s = 500;
    std::string from = "127.0.0.1";  ///< an address of this machine
    int ports = 1;                   ///< in turn
  };

  explicit AnnouncementFlood(Options options);
  AnnouncementFlood(const AnnouncementFlood&) = delete;
  AnnouncementFlood& operator=(const AnnouncementFlood&) = delete;
  ~AnnouncementFlood();

  std::uint64_t sent() const { return sent_; }

 private:
  void send_until(const std::stop_token& stop);

  const Options options_;
  std::vector<int> sockets_;
  std::atomic<std::uint64_t> sent_ = 0;
  std::jthread thread_;  // last: uses the others
};

}  // namespace kinship::test
