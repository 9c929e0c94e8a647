#include "server/store/values/consistency_token.hpp"

#include <algorithm>

#include "proto/types/sha256.hpp"

namespace kinship::store {
namespace {

constexpr std::size_t kUuidBytes = 16, kPositionBytes = 8, kSignatureBytes = 16;
constexpr std::size_t kTokenBytes = kUuidBytes + kPositionBytes + kSignatureBytes;

}  // namespace

Digest random_key() {
  Digest key;
  for (std::size_t half = 0; half < 2; ++half) {
    const Uuid random = Uuid::random();
    std::ranges::copy(random.bytes, key.bytes.begin() + kUuidBytes * half);
  }
  return key;
}

ConsistencyToken sign(const Digest& key, const Uuid& epoch, const LogPosition& point) {
  ConsistencyToken token(point.run.bytes.begin(), point.run.bytes.end());
  for (std::size_t i = 0; i < kPositionBytes; ++i)
    token.push_back(static_cast<std::uint8_t>(point.position >> (8 * i)));
  std::vector<std::uint8_t> message(epoch.bytes.begin(), epoch.bytes.end());
  message.insert(message.end(), token.begin(), token.end());
  const Digest whole = hmac_sha256(key, message);
  token.insert(token.end(), whole.bytes.begin(), whole.bytes.begin() + kSignatureBytes);
  return token;
}

std::optional<LogPosition> verify(const Digest& key, const Uuid& epoch,
                                  const ConsistencyToken& token) {
  if (token.size() != kTokenBytes)
    return std::nullopt;
  LogPosition point;
  std::copy_n(token.begin(), kUuidBytes, point.run.bytes.begin());
  for (std::size_t i = 0; i < kPositionBytes; ++i)
    point.position |= static_cast<std::uint64_t>(token[kUuidBytes + i]) << (8 * i);
  if (sign(key, epoch, point) != token)
    return std::nullopt;
  return point;
}

}  // namespace kinship::store
