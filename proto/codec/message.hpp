#pragma once

#include <memory>
#include <string>

#include "proto/codec/arena.hpp"
#include "proto/codec/conversation.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/result.hpp"

namespace kinship::codec {

/// An outgoing message with the memory its members point to. Movable.
template <typename Wire>
struct Message {
  Wire wire{};
  std::unique_ptr<Arena> arena = std::make_unique<Arena>();

  Message() = default;  ///< of a publication: it has no head
  explicit Message(const Head& head) {
    std::memcpy(wire.client_id, head.client_id.bytes.data(), sizeof wire.client_id);
    wire.sequence_number = head.sequence_number;
  }
};

/// The message if it fits into a sample, else TooLarge.
template <typename Wire>
Result<Message<Wire>> limited(Message<Wire> message) {
  const std::size_t bytes = sizeof(Wire) + message.arena->bytes();
  if (bytes > kMaxSampleBytes)
    return Error{ErrorCode::TooLarge, "message: " + std::to_string(bytes) + " bytes exceed " +
                                          std::to_string(kMaxSampleBytes)};
  return message;
}

/// The first members of any message.
template <typename Wire>
Head head_of(const Wire& wire) {
  Head head;
  std::memcpy(head.client_id.bytes.data(), wire.client_id, sizeof wire.client_id);
  head.sequence_number = wire.sequence_number;
  return head;
}

}  // namespace kinship::codec
