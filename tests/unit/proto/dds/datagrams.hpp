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
  std::optional<std::uint32_t> version_flags = {};  ///< of Cyclone DDS's own parameter
  std::uint8_t submessage = 0x15;                   ///< DATA
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
  if (parts.version_flags) {
    append(body, {7, 0x80, 12, 0, 0, 0, 0, 0});
    append_u32(body, *parts.version_flags);
    append_u32(body, 0);
  }
  append(body, {1, 0, 0, 0});
  return submessage(parts.submessage, parts.is_departure ? 3 | 8 : 1 | 4, body);
}

inline Bytes announcement(const AnnouncementParts& parts = {}) {
  Bytes bytes = rtps_header(parts.sender);
  append(bytes, submessage(0x09, 1, {0, 0, 0, 0, 0, 0, 0, 0}));
  append(bytes, announcement_submessage(parts));
  return bytes;
}

/// INFO_SRC: who sends what follows.
inline Bytes source_submessage(const dds::GuidPrefix& sender) {
  Bytes body(8);
  body.insert(body.end(), sender.begin(), sender.end());
  return submessage(0x0c, 1, body);
}

/// DATA, or with 0x16 the only DATA_FRAG, of a writer about an endpoint or a participant.
/// \param writer  3 or 4: of endpoints; 0: of liveliness.
/// \param flags   of the submessage: 1, and 2 for an end, 4 for data, 8 for a key.
inline Bytes told_of(const dds::GuidPrefix& about, std::uint8_t writer, std::uint8_t flags,
                     std::uint8_t id = 0x15) {
  const bool is_liveliness = writer == 0;
  Bytes body = {0, 0, 16, 0, 0, 0, 0, 0, 0, 0, writer, 0xc2, 0, 0, 0, 0, 1, 0, 0, 0};
  if (is_liveliness)
    body[9] = 2;
  if (id == 0x16) {
    body[2] = 28;
    append(body, {1, 0, 0, 0, 1, 0, 0, 4, 64, 0, 0, 0});
  }
  if ((flags & 2U) != 0) {
    append(body, {0x71, 0, 4, 0, 0, 0, 0, 3, 0x70, 0, 16, 0});
    body.insert(body.end(), about.begin(), about.end());
    append(body, {0, 0, 1, 2, 1, 0, 0, 0});
  }
  if ((flags & (4U | 8U)) == 0)
    return submessage(id, flags, body);
  append(body, is_liveliness ? Bytes{0, 1, 0, 0} : Bytes{0, 3, 0, 0, 0x5a, 0, 16, 0});
  body.insert(body.end(), about.begin(), about.end());
  append(body,
         is_liveliness ? Bytes{0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0} : Bytes{0, 0, 1, 2, 1, 0, 0, 0});
  return submessage(id, flags, body);
}

}  // namespace kinship::test
