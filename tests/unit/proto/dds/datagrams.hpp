#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/dds/datagram.hpp"

namespace kinship::test {

using Bytes = std::vector<std::uint8_t>;

/// Parts of an announcement of a participant (SPDP), to be made well or badly.
struct AnnouncementParts {
  dds::GuidPrefix sender{1, 16, 2, 3};
  std::optional<dds::GuidPrefix> about = {};  ///< empty: the sender
  std::optional<std::uint32_t> lease_s = 5;
  bool has_identity = false;
  bool is_departure = false;
  std::uint8_t submessage = 0x15;  ///< DATA
};

inline void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

inline void append_u32(Bytes& bytes, std::uint32_t value) {
  for (int i = 0; i < 4; ++i)
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// The header of a datagram, little endian in what follows it.
inline Bytes rtps_header(const dds::GuidPrefix& sender) {
  Bytes bytes = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
  bytes.insert(bytes.end(), sender.begin(), sender.end());
  return bytes;
}

inline Bytes submessage(std::uint8_t id, std::uint8_t flags, const Bytes& body) {
  Bytes bytes = {id, flags, static_cast<std::uint8_t>(body.size()),
                 static_cast<std::uint8_t>(body.size() >> 8U)};
  append(bytes, body);
  return bytes;
}

inline Bytes announcement_submessage(const AnnouncementParts& parts) {
  Bytes body = {0, 0, 16, 0, 0, 0, 0, 0, 0, 1, 0, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  if (parts.is_departure)
    append(body, {0x71, 0, 4, 0, 0, 0, 0, 3, 1, 0, 0, 0});
  append(body, {0, 3, 0, 0});
  append(body, {0x50, 0, 16, 0});
  const dds::GuidPrefix& about = parts.about ? *parts.about : parts.sender;
  body.insert(body.end(), about.begin(), about.end());
  append(body, {0, 0, 1, 0xc1});
  if (parts.lease_s) {
    append(body, {2, 0, 8, 0});
    append_u32(body, *parts.lease_s);
    append_u32(body, 0);
  }
  if (parts.has_identity)
    append(body, {1, 0x10, 4, 0, 0, 0, 0, 0});
  append(body, {1, 0, 0, 0});
  return submessage(parts.submessage, parts.is_departure ? 3 | 8 : 1 | 4, body);
}

inline Bytes announcement(const AnnouncementParts& parts = {}) {
  Bytes bytes = rtps_header(parts.sender);
  append(bytes, submessage(0x09, 1, {0, 0, 0, 0, 0, 0, 0, 0}));
  append(bytes, announcement_submessage(parts));
  return bytes;
}

}  // namespace kinship::test
