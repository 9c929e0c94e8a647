#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string_view>

namespace kinship::dds {

/// Whether serialised bytes (CDR) of a type declare a length beyond their end. Cyclone DDS 0.10.2
/// checks for 4 bytes before an 8-byte number of XCDR2, and for half of a list of such numbers, and
/// reads and swaps bytes beyond the end; fixed upstream later.
///
/// Supports the types of this project's IDL: numbers, strings, structures, arrays and sequences of
/// them. Returns false for other types (Cyclone DDS's own, for type look-up).
/// \param bytes    the body, without its encapsulation header.
/// \param swapped  whether their byte order differs from this machine's.
/// \param version  of the representation: 1 XCDR1, 2 XCDR2.
/// \param ops      serialisation operations of the type from idlc: dds_topic_descriptor_t::m_ops.
bool overruns(std::span<const std::uint8_t> bytes, bool swapped, std::uint32_t version,
              const std::uint32_t* ops);

/// Whether a message is longer than any valid one of its type: the server has to hold many that
/// wait (Topics::held_requests, ros2::Channel).
/// \param type  its name: kinship::wire::FetchRequest.
bool is_too_long(std::size_t size, std::string_view type);

/// Admits some of the requests that are too long, to be refused with a message. May be shared
/// between threads.
class LongRequests {
 public:
  static constexpr int kMaxPerSecond = 64;
  bool admit(std::chrono::steady_clock::time_point now);

 private:
  std::mutex mutex_;
  std::chrono::steady_clock::time_point begin_{};  // of a second; guarded by mutex_, like all below
  int count_ = 0;                                  // in it
};

/// Whether Cyclone DDS calls overruns() before it reads a message: this library interposes a
/// function of Cyclone DDS, which may fail in a program that is linked otherwise.
bool is_message_guard_in_place();

}  // namespace kinship::dds
