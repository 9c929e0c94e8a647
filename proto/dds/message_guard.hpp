#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string_view>

namespace kinship::dds {

/// Whether serialised bytes (CDR) of a type state a length that is not there. Cyclone DDS 0.10.2
/// looks for 4 bytes where an 8-byte number of XCDR2 stands, and for half of a list of such
/// numbers, and reads and swaps what lies behind; fixed upstream later.
///
/// Knows what the IDL of this project uses: numbers, strings, structures, arrays and sequences of
/// them. Of other types (Cyclone DDS's own, by which it asks for types) it says nothing: false.
/// \param bytes    the body, without its encapsulation header.
/// \param swapped  whether they have the other byte order than this machine.
/// \param version  of the representation: 1 XCDR1, 2 XCDR2.
/// \param ops      what idlc says of the type: dds_topic_descriptor_t::m_ops.
bool overruns(std::span<const std::uint8_t> bytes, bool swapped, std::uint32_t version,
              const std::uint32_t* ops);

/// Whether a message is longer than one of its type ever is: many of them wait for the server
/// (Topics::held_requests), who has to hold them.
/// \param type  its name: kinship::wire::FetchRequest.
bool is_too_long(std::size_t size, std::string_view type);

/// Lets some of them in, to be refused in words. May be shared between threads.
class LongRequests {
 public:
  static constexpr int kMaxPerSecond = 64;
  bool admit(std::chrono::steady_clock::time_point now);

 private:
  std::mutex mutex_;
  std::chrono::steady_clock::time_point begin_{};  // of a second; guarded by mutex_, like all below
  int count_ = 0;                                  // in it
};

/// Whether Cyclone DDS asks overruns() before it reads a message: this library puts a function
/// in front of Cyclone DDS's own, which a program that is linked otherwise may miss.
bool is_message_guard_in_place();

}  // namespace kinship::dds
