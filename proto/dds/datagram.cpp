#include "proto/dds/datagram.hpp"

#include <algorithm>
#include <cstddef>

namespace kinship::dds {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHeaderBytes = 20, kSubmessageHeaderBytes = 4, kPrefixAt = 8;
constexpr int kMaxAnnouncements = 2;  // packed: it comes, and goes at once

enum SubmessageId : std::uint8_t {
  Pad = 0x01,
  InfoTime = 0x09,
  InfoSource = 0x0c,
  Data = 0x15,
  DataFragment = 0x16
};

/// Numbers at places in bytes of one byte order; nothing beyond their end.
class Reader {
 public:
  Reader(Bytes bytes, bool is_little) : bytes_(bytes), is_little_(is_little) {}

  std::size_t size() const { return bytes_.size(); }
  std::optional<Bytes> bytes(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at)
      return std::nullopt;
    return bytes_.subspan(at, size);
  }
  template <typename Number>
  std::optional<Number> number(std::size_t at) const {
    const std::optional<Bytes> found = bytes(at, sizeof(Number));
    if (!found)
      return std::nullopt;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      value = value << 8U | (*found)[is_little_ ? sizeof(Number) - 1 - i : i];
    return static_cast<Number>(value);
  }

 private:
  Bytes bytes_;
  bool is_little_;
};

bool are(Bytes bytes, std::initializer_list<std::uint8_t> expected) {
  return std::ranges::equal(bytes, expected);
}

/// Whether these are the writers by which participants announce themselves.
bool is_announcer(Bytes writer) {
  return are(writer, {0x00, 0x01, 0x00, 0xc2}) || are(writer, {0xff, 0x01, 0x01, 0xc2});
}

/// Whether this writer announces endpoints and their ends.
bool is_endpoint_announcer(Bytes writer) {
  return are(writer, {0x00, 0x00, 0x03, 0xc2}) || are(writer, {0x00, 0x00, 0x04, 0xc2});
}

/// Whether this writer tells of participants' liveliness and ends.
bool is_liveliness_writer(Bytes writer) { return are(writer, {0x00, 0x02, 0x00, 0xc2}); }

/// Calls `use(id, value)` for each parameter of a list. \return where the list ends, if it does.
template <typename Use>
std::optional<std::size_t> walk_parameters(const Reader& list, std::size_t at, const Use& use) {
  constexpr std::uint16_t kSentinel = 1, kMustBeUnderstood = 0x4000;
  while (true) {
    const auto id = list.number<std::uint16_t>(at);
    const auto length = list.number<std::uint16_t>(at + 2);
    if (!id || !length)
      return std::nullopt;
    at += 4;
    if (*id == kSentinel)
      return at;
    const auto value = list.bytes(at, *length);
    if (!value || *length % 4 != 0 ||
        !use(static_cast<std::uint16_t>(*id & ~kMustBeUnderstood), *value))
      return std::nullopt;
    at += *length;
  }
}

constexpr std::size_t kEncapsulationBytes = 4, kGuidBytes = 16;

bool is_parameter_list(Bytes payload) {
  return payload.size() >= kEncapsulationBytes && payload[0] == 0 &&
         (payload[1] == 2 || payload[1] == 3);
}

bool is_of(const GuidPrefix& sender, Bytes guid) {
  return guid.size() == kGuidBytes && std::ranges::equal(guid.first(sender.size()), sender);
}

/// What the parameters of an announcement say. \return whether they are well formed and about
/// `sender` itself.
bool read_payload(Bytes payload, const GuidPrefix& sender, ParticipantAnnouncement& found) {
  enum : std::uint16_t { Lease = 0x0002, Guid = 0x0050, Identity = 0x1001, Version = 0x8007 };
  if (!is_parameter_list(payload))
    return false;
  const bool is_little = payload[1] == 3;
  found.lease = std::chrono::seconds(100);  // where none is said
  int guids = 0;
  const auto use = [&](std::uint16_t id, Bytes value) {
    if (id == Guid) {
      ++guids;
      return is_of(sender, value) && are(value.subspan(sender.size()), {0x00, 0x00, 0x01, 0xc1});
    }
    if (id == Version) {
      constexpr std::uint32_t kIsDdsi2 = 1U << 4U;
      const auto version_flags = Reader(value, is_little).number<std::uint32_t>(4);
      return version_flags && (*version_flags & kIsDdsi2) == 0;
    }
    if (id == Identity)
      found.has_identity = true;
    if (id != Lease)
      return true;
    const Reader reader(value, is_little);
    const auto seconds = reader.number<std::uint32_t>(0);
    const auto fraction = reader.number<std::uint32_t>(4);
    if (!seconds || !fraction)
      return false;
    constexpr std::uint32_t kDay_s = 86'400;
    found.lease = std::chrono::seconds(std::min(*seconds, kDay_s) + (*fraction != 0 ? 1 : 0));
    return true;
  };
  return walk_parameters(Reader(payload, is_little), kEncapsulationBytes, use) && guids == 1;
}

/// Whether the payload is about one endpoint, of the sender.
bool is_own_endpoint(Bytes payload, const GuidPrefix& sender) {
  enum : std::uint16_t { ParticipantGuid = 0x0050, EndpointGuid = 0x005a };
  if (!is_parameter_list(payload))
    return false;
  bool is_found = false;
  const auto use = [&](std::uint16_t id, Bytes value) {
    is_found = is_found || id == EndpointGuid;
    return (id != ParticipantGuid && id != EndpointGuid) || is_of(sender, value);
  };
  return walk_parameters(Reader(payload, payload[1] == 3), kEncapsulationBytes, use) && is_found;
}

/// Whether the payload is about the sender: a prefix and what it says.
bool is_own_liveliness(Bytes payload, const GuidPrefix& sender) {
  return payload.size() >= kEncapsulationBytes + sender.size() &&
         std::ranges::equal(payload.subspan(kEncapsulationBytes, sender.size()), sender);
}

struct InlineQos {
  std::size_t end = 0;  ///< where it ends
  bool is_end = false;  ///< of what the payload or the key names
  bool has_own_key = false;
};

/// \return nothing if it is broken or has the key of another participant than the sender.
std::optional<InlineQos> read_inline_qos(const Reader& reader, std::size_t at,
                                         const GuidPrefix& sender) {
  enum : std::uint16_t { KeyHash = 0x0070, Status = 0x0071 };
  InlineQos found;
  const auto use = [&](std::uint16_t id, Bytes value) {
    if (id == KeyHash)
      return found.has_own_key = is_of(sender, value);
    if (id != Status)
      return true;
    found.is_end = !value.empty() && (value.back() & 3U) != 0;
    return value.size() == 4;
  };
  const auto end = walk_parameters(reader, at, use);
  if (!end)
    return std::nullopt;
  found.end = *end;
  return found;
}

/// A DATA_FRAG submessage. \return whether it may be heard: an end is never cut in pieces.
bool read_fragment(Bytes body, std::uint8_t flags) {
  constexpr std::size_t kWriterAt = 8;
  enum : std::uint8_t { InlineQos = 2, Key = 4 };
  const auto writer = Reader(body, true).bytes(kWriterAt, 4);
  if (!writer || is_announcer(*writer) || is_liveliness_writer(*writer))
    return false;
  return !is_endpoint_announcer(*writer) || (flags & (InlineQos | Key)) == 0;
}

/// A DATA submessage. \return whether it may be heard.
bool read_data(Bytes body, std::uint8_t flags, Datagram& datagram, int& announcements) {
  enum : std::uint8_t { Little = 1, HasQos = 2, HasData = 4, HasKey = 8 };
  constexpr std::size_t kOffsetAt = 2, kWriterAt = 8, kFixedBytes = 20;
  const Reader reader(body, (flags & Little) != 0);
  const auto writer = reader.bytes(kWriterAt, 4);
  if (!writer)
    return false;
  const bool is_announcement = is_announcer(*writer);
  if (!is_announcement && !is_endpoint_announcer(*writer) && !is_liveliness_writer(*writer))
    return true;
  const auto offset = reader.number<std::uint16_t>(kOffsetAt);
  std::size_t at = kOffsetAt + 2 + offset.value_or(0);
  if (!offset || at < kFixedBytes || at > body.size())
    return false;
  const auto qos = (flags & HasQos) != 0 ? read_inline_qos(reader, at, datagram.sender)
                                         : std::optional(InlineQos{.end = at});
  if (!qos)
    return false;
  const Bytes payload = body.subspan(qos->end);
  if (!is_announcement) {
    if ((flags & (HasData | HasKey)) == 0)
      return qos->has_own_key;
    return is_liveliness_writer(*writer) ? is_own_liveliness(payload, datagram.sender)
                                         : is_own_endpoint(payload, datagram.sender);
  }
  ParticipantAnnouncement found{.is_departure = qos->is_end};
  if (++announcements > kMaxAnnouncements || !read_payload(payload, datagram.sender, found))
    return false;
  datagram.announcement = found;
  return true;
}

/// The submessage with this body. \return whether it may be heard.
bool read_submessage(std::uint8_t id, std::uint8_t flags, Bytes body, Datagram& datagram,
                     int& announcements) {
  switch (id) {
    case InfoSource: {
      constexpr std::size_t kMaxOthers = 255;
      const auto prefix = Reader(body, true).bytes(kPrefixAt, datagram.sender.size());
      if (!prefix || datagram.others.size() >= kMaxOthers)
        return false;
      announcements = 0;
      std::ranges::copy(*prefix, datagram.others.emplace_back().sender.begin());
      return true;
    }
    case Data:
      return read_data(body, flags, datagram.others.empty() ? datagram : datagram.others.back(),
                       announcements);
    case DataFragment:
      return read_fragment(body, flags);
    default:
      return true;
  }
}

}  // namespace

std::optional<Datagram> read_datagram(Bytes bytes) {
  if (bytes.size() < kHeaderBytes || !are(bytes.first(4), {'R', 'T', 'P', 'S'}))
    return std::nullopt;
  Datagram datagram;
  std::ranges::copy(bytes.subspan(kPrefixAt, datagram.sender.size()), datagram.sender.begin());
  int announcements = 0;
  std::size_t at = kHeaderBytes;
  const auto sender_now = [&]() -> Datagram& {
    return datagram.others.empty() ? datagram : datagram.others.back();
  };
  datagram.begin = at;
  while (bytes.size() - at >= kSubmessageHeaderBytes) {
    const std::uint8_t id = bytes[at], flags = bytes[at + 1];
    const auto length = Reader(bytes, (flags & 1U) != 0).number<std::uint16_t>(at + 2);
    if (id == InfoSource)
      sender_now().end = at;
    const std::size_t begin = at;
    at += kSubmessageHeaderBytes;
    const bool is_rest = *length == 0 && id != Pad && id != InfoTime;
    const std::size_t size = is_rest ? bytes.size() - at : *length;
    if (size > bytes.size() - at || (!is_rest && size % 4 != 0) ||
        !read_submessage(id, flags, bytes.subspan(at, size), datagram, announcements))
      return std::nullopt;
    at += size;
    if (id == InfoSource)
      sender_now().begin = begin;
  }
  sender_now().end = at;
  if (at != bytes.size())
    return std::nullopt;
  return datagram;
}

}  // namespace kinship::dds
