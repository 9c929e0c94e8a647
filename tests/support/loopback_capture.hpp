#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace kinship::test {

/// One message of RTPS as it was sent over loopback.
struct CapturedMessage {
  std::uint16_t port = 0;  ///< to which
  std::string bytes;
};

/// Sees all that is sent by UDP over loopback from its construction on, as tcpdump would.
class LoopbackCapture {
 public:
  /// \return nothing if this process may not.
  static std::optional<LoopbackCapture> start();
  LoopbackCapture(LoopbackCapture&& other) noexcept;
  LoopbackCapture& operator=(LoopbackCapture&&) = delete;
  ~LoopbackCapture();

  /// All since the last call.
  std::vector<CapturedMessage> take() const;

 private:
  explicit LoopbackCapture(int socket) : socket_(socket) {}

  int socket_;
};

/// The message with the number of its DATA submessage changed; nothing if it has none.
std::optional<CapturedMessage> renumbered(CapturedMessage message, std::uint32_t more);

/// Sends it again.
void send_again(const CapturedMessage& message);

}  // namespace kinship::test
