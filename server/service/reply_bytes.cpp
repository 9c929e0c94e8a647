#include "server/service/reply_bytes.hpp"

#include <variant>

namespace kinship::service {

std::size_t reply_bytes(const FetchReply& reply) {
  constexpr std::size_t kFixedBytes = 512, kSourceBytes = 256, kPathBytes = 96, kPoseBytes = 28;
  std::size_t bytes = kFixedBytes;
  if (reply.distribution) {
    bytes += kSourceBytes * reply.distribution->sources.size();
    if (const auto& mixture = reply.distribution->mixture) {
      const auto components = static_cast<std::size_t>(mixture->size());
      const auto dimension = static_cast<std::size_t>(mixture->dimension());
      const std::size_t triangle = dimension * (dimension + 1) / 2;
      bytes += sizeof(double) *
               (components * (1 + dimension) + mixture->covariances().size() * triangle);
    }
  }
  if (reply.experience)
    for (const auto& path : reply.experience->paths)
      bytes += kPathBytes + kPoseBytes * path.poses.size();
  if (reply.recall)
    bytes += recall_bytes(*reply.recall);
  return bytes;
}

std::size_t reply_bytes(const AdminPage& page) {
  constexpr std::size_t kRowBytes = 512;
  std::size_t bytes = kRowBytes;
  for (const AdminRow& row : page.rows) {
    const auto* const line = std::get_if<TextLine>(&row);
    bytes += line != nullptr ? line->text.size() : kRowBytes;
  }
  return bytes;
}

}  // namespace kinship::service
