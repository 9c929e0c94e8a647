#pragma once

#include <cstdint>

namespace kinship::test {

/// A DDS domain that is nobody else's while this object lives: tests run side by side, each with a
/// server of its own, and beside other software.
///
/// Programs that use it run in a network of their own where that is permitted. Where it is not,
/// the domain is one whose ports nobody has. They lie below the range from which the system gives
/// ports to whoever asks for any (32768 to 60999), so that none is taken before the server starts.
class ReservedDomain {
 public:
  static constexpr std::uint32_t kFirst = 70, kLast = 101;

  /// Waits if all are reserved.
  /// \throws std::runtime_error if other software has ports of all of them.
  ReservedDomain();
  ~ReservedDomain();
  ReservedDomain(const ReservedDomain&) = delete;
  ReservedDomain& operator=(const ReservedDomain&) = delete;

  std::uint32_t number() const noexcept { return number_; }

 private:
  std::uint32_t number_ = 0;
  int claim_ = -1;
};

}  // namespace kinship::test
