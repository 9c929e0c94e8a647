// Bytes from the network as a datagram: nothing, or what is within its bytes, the same each time.

#include <chrono>

#include "proto/dds/peer_table.hpp"
#include "tests/fuzz/demand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kinship;
  const std::span<const std::uint8_t> bytes(data, size);
  const auto read = dds::read_datagram(bytes);
  if (!read)
    return 0;
  fuzz::demand(std::equal(read->sender.begin(), read->sender.end(), bytes.begin() + 8),
               "the sender is the header's");
  if (read->announcement)
    fuzz::demand(read->announcement->lease >= std::chrono::seconds(0) &&
                     read->announcement->lease <= std::chrono::hours(24) + std::chrono::seconds(1),
                 "a lease is a day at most");
  static dds::PeerTable table;
  static dds::PeerTable::TimePoint now{std::chrono::hours(1)};
  now += std::chrono::milliseconds(1);
  table.take(read, dds::PacketSource::ipv4({10, 0, 0, data[size - 1]}, data[size - 2]),
             size % 2 == 0, size % 3 == 0, now);
  fuzz::demand(table.size() <= dds::PeerTable::kMaxPeers, "the table has bounds");
  return 0;
}
