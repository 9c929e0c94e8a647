#include "proto/dds/message_guard.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/ddsi_serdata_default.h>
#include <dds/ddsi/ddsi_xt_impl.h>
#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "proto/dds/wire.hpp"

namespace kinship::dds {
namespace {

/// A walk over bytes along the instructions of a type. Every function says whether the bytes go on.
class Walk {
 public:
  Walk(std::span<const std::uint8_t> bytes, bool swapped, std::uint32_t version)
      : bytes_(bytes), end_(bytes.size()), swapped_(swapped), version_(version) {}

  /// All members of a structure.
  bool structure(const std::uint32_t* ops) {
    if (DDS_OP(*ops) != DDS_OP_DLC)
      return members(ops);
    const std::optional<std::uint32_t> size = version_ == kXcdr2 ? number() : std::nullopt;
    if (!size || *size > end_ - position_)
      return false;
    const std::size_t outer = end_;
    end_ = position_ + *size;
    if (!members(ops + 1))
      return false;
    position_ = end_;  // members that a newer sender knows
    end_ = outer;
    return true;
  }

  /// Whether it ended at an instruction that it does not know.
  bool met_unknown() const { return met_unknown_; }

 private:
  static constexpr std::uint32_t kXcdr2 = 2;

  bool unknown() {
    met_unknown_ = true;
    return false;
  }

  /// Members until the last one, or until the bytes end: an older sender has fewer.
  bool members(const std::uint32_t* ops) {
    while (DDS_OP(*ops) != DDS_OP_RTS) {
      if (position_ == end_)
        return true;
      if (DDS_OP(*ops) != DDS_OP_ADR || (*ops & kNotOurs) != 0)
        return unknown();
      ops = member(ops);
      if (ops == nullptr)
        return false;
    }
    return true;
  }

  /// \return the next member's instruction.
  const std::uint32_t* member(const std::uint32_t* ops) {
    switch (DDS_OP_TYPE(*ops)) {
      case DDS_OP_VAL_STR:
        return string() ? ops + 2 : nullptr;
      case DDS_OP_VAL_BST:
        return string() ? ops + 3 : nullptr;
      case DDS_OP_VAL_EXT: {
        const std::uint32_t jump = DDS_OP_ADR_JMP(ops[2]);
        return structure(ops + DDS_OP_ADR_JSR(ops[2])) ? ops + (jump != 0 ? jump : 3) : nullptr;
      }
      case DDS_OP_VAL_SEQ:
        return list(ops, ops + 2, std::nullopt);
      case DDS_OP_VAL_BSQ:
        return list(ops, ops + 3, std::nullopt);
      case DDS_OP_VAL_ARR:
        return list(ops, ops + 3, ops[2]);
      default: {
        const std::size_t size = size_of(DDS_OP_TYPE(*ops));
        return (size > 0 || unknown()) && numbers(size, 1) ? ops + 2 : nullptr;
      }
    }
  }

  /// A sequence, or an array of so many elements.
  /// \param rest  of the instruction: behind its own bound or length.
  const std::uint32_t* list(const std::uint32_t* ops, const std::uint32_t* rest,
                            std::optional<std::uint32_t> length) {
    const bool is_array = length.has_value();
    const auto element = DDS_OP_SUBTYPE(*ops);
    const std::size_t size = size_of(element);
    // Its own size precedes a list of anything but numbers.
    if (size == 0 && version_ == kXcdr2 && !number())
      return nullptr;
    if (!length)
      length = number();
    if (!length)
      return nullptr;
    if (size > 0)
      return numbers(size, *length) ? rest : nullptr;
    if (element == DDS_OP_VAL_STR)
      return strings(*length) ? rest : nullptr;
    if (element != DDS_OP_VAL_STU && !unknown())
      return nullptr;
    // A sequence says its element's size before where the element is described, an array after.
    const std::uint32_t place = is_array ? rest[0] : rest[1];
    for (std::uint32_t i = 0; i < *length; ++i)
      if (!structure(ops + DDS_OP_ADR_JSR(place)))
        return nullptr;
    const std::uint32_t jump = DDS_OP_ADR_JMP(place);
    return jump != 0 ? ops + jump : rest + 2;
  }

  bool strings(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i)
      if (!string())
        return false;
    return true;
  }

  bool string() {
    const std::optional<std::uint32_t> size = number();
    return size && *size > 0 && numbers(1, *size);
  }

  /// Numbers of equal size, aligned.
  bool numbers(std::size_t size, std::size_t count) {
    const std::size_t alignment = version_ == kXcdr2 && size > 4 ? 4 : size;
    const std::size_t begin = (position_ + alignment - 1) / alignment * alignment;
    if (count > 0 && (begin > end_ || count > (end_ - begin) / size))
      return false;
    if (count > 0)
      position_ = begin + count * size;
    return true;
  }

  std::optional<std::uint32_t> number() {
    if (!numbers(sizeof(std::uint32_t), 1))
      return std::nullopt;
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + position_ - sizeof value, sizeof value);
    return swapped_ ? __builtin_bswap32(value) : value;
  }

  /// Of a number; 0 for other types.
  static std::size_t size_of(dds_stream_typecode type) {
    switch (type) {
      case DDS_OP_VAL_BLN:
      case DDS_OP_VAL_1BY:
        return 1;
      case DDS_OP_VAL_2BY:
        return 2;
      case DDS_OP_VAL_4BY:
        return 4;
      case DDS_OP_VAL_8BY:
        return 8;
      default:
        return 0;
    }
  }

  /// Optional members, base types, members behind pointers.
  static constexpr std::uint32_t kNotOurs = DDS_OP_FLAG_OPT | DDS_OP_FLAG_BASE | DDS_OP_FLAG_EXT;

  std::span<const std::uint8_t> bytes_;
  std::size_t position_ = 0;
  std::size_t end_;  // of the structure that is walked over
  bool swapped_;
  std::uint32_t version_;
  bool met_unknown_ = false;
};

}  // namespace

bool is_too_long(std::size_t size, std::string_view type) {
  constexpr std::string_view kOfRos = "kinship_msgs::";
  constexpr std::array<std::string_view, 4> kLongOfRos = {"::PlannedPath_", "::Report_Request_",
                                                          "::Registration_", "::Register_Request_"};
  if (type.starts_with(kOfRos) && std::ranges::any_of(kLongOfRos, [type](std::string_view name) {
        return type.ends_with(name);
      }))
    return size > kMaxShortPathBytes;
  return size > kMaxShortRequestBytes &&
         (type.starts_with(kOfRos) || type == kinship_wire_FetchRequest_desc.m_typename ||
          type == kinship_wire_AdminRequest_desc.m_typename);
}

bool LongRequests::admit(std::chrono::steady_clock::time_point now) {
  const std::lock_guard lock(mutex_);
  if (now - begin_ >= std::chrono::seconds(1)) {
    begin_ = now;
    count_ = 0;
  }
  return ++count_ <= kMaxPerSecond;
}

bool overruns(std::span<const std::uint8_t> bytes, bool swapped, std::uint32_t version,
              const std::uint32_t* ops) {
  Walk walk(bytes, swapped, version);
  return !walk.structure(ops) && !walk.met_unknown();
}

}  // namespace kinship::dds

/// In front of the function of this name in Cyclone DDS, which calls it for each message from the
/// network: a program's own symbols come before those of libraries.
// NOLINTNEXTLINE(readability-function-size): its parameters are Cyclone DDS's
extern "C" __attribute__((visibility("default"))) bool dds_stream_normalize(
    void* data, std::uint32_t size, bool swapped, std::uint32_t version,
    const ddsi_sertype_default* type, bool just_key, std::uint32_t* actual_size) {
  static const auto kBehind = reinterpret_cast<decltype(&dds_stream_normalize)>(
      dlsym(RTLD_NEXT, "dds_stream_normalize"));  // NOLINT: what dlsym is for
  const char* const name = type->c.type_name;
  static kinship::dds::LongRequests admitted;
  if (name != nullptr && kinship::dds::is_too_long(size, name) &&
      !admitted.admit(std::chrono::steady_clock::now()))
    return false;
  const std::span<const std::uint8_t> bytes(static_cast<const std::uint8_t*>(data), size);
  if (!just_key && kinship::dds::overruns(bytes, swapped, version, type->type.ops.ops))
    return false;
  return kBehind(data, size, swapped, version, type, just_key, actual_size);
}

/// In front of the function of this name in Cyclone DDS, which is asked about the type of each
/// reader and writer that a peer announces, and ends the process at kinds it does not know.
extern "C" __attribute__((visibility("default"))) bool ddsi_typeinfo_valid(
    const ddsi_typeinfo_t* type) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsi_typeinfo_valid)>(
      dlsym(RTLD_NEXT, "ddsi_typeinfo_valid"));  // NOLINT: what dlsym is for
  return type->x.minimal.typeid_with_size.type_id._d == DDS_XTypes_EK_MINIMAL &&
         type->x.complete.typeid_with_size.type_id._d == DDS_XTypes_EK_COMPLETE && kBehind(type);
}

bool kinship::dds::is_message_guard_in_place() {
  const auto is_in_front = [](const char* name, auto* function) {
    return dlsym(RTLD_DEFAULT, name) == reinterpret_cast<void*>(function);  // NOLINT: as above
  };
  return is_in_front("dds_stream_normalize", &dds_stream_normalize) &&
         is_in_front("ddsi_typeinfo_valid", &ddsi_typeinfo_valid);
}
