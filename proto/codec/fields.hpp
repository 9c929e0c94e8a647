#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/codec/arena.hpp"
#include "proto/codec/message.hpp"
#include "proto/codec/reader.hpp"
#include "proto/codec/writer.hpp"
#include "proto/idl/admin.h"
#include "proto/idl/report.h"
#include "proto/types/enum_text.hpp"
#include "proto/types/field.hpp"

/// Values as messages by the tables of their fields, for structures of the IDL that have the fields
/// of a value in the order of its table, after the head if they have one
/// (tests/unit/proto/codec compares the names). A part without a table has
/// `write_part(part, arena, wire)` and `read_part(wire, reader, part)`. For the sources of this
/// folder only.
namespace kinship::codec {

/// Type of a member in the structure that idlc generates.
template <typename T>
struct WireMember {
  static constexpr bool kIsCount = std::is_enum_v<T> || std::is_same_v<T, int> || kIsDuration<T>;
  using Type = std::conditional_t<kIsCount, std::uint32_t, T>;
};
template <>
struct WireMember<std::string> {
  using Type = char*;
};
template <>
struct WireMember<Digest> {
  using Type = std::uint8_t[32];
};
template <>
struct WireMember<Uuid> {
  using Type = std::uint8_t[16];
};
template <>
struct WireMember<Eigen::Isometry3d> {
  using Type = double[7];
};
template <>
struct WireMember<std::optional<Digest>> {
  using Type = dds_sequence_octet;
};
template <>
struct WireMember<std::optional<Eigen::Isometry3d>> {
  using Type = dds_sequence_double;
};
template <>
struct WireMember<std::vector<std::uint8_t>> {
  using Type = dds_sequence_octet;
};
template <>
struct WireMember<std::vector<std::string>> {
  using Type = dds_sequence_string;
};
template <>
struct WireMember<std::vector<double>> {
  using Type = dds_sequence_double;
};

/// Offset of a member after `end` bytes of others, as C lays out structures.
template <typename Type>
constexpr std::size_t place_after(std::size_t end) {
  return (end + alignof(Type) - 1) / alignof(Type) * alignof(Type);
}

/// Bytes of a message before the fields of its value.
template <typename Wire>
constexpr std::size_t head_bytes() {
  if constexpr (requires { Wire::sequence_number; })
    return sizeof(Wire::client_id) + sizeof(Wire::sequence_number);
  else
    return 0;
}

/// Calls visit(field, member) for each field of a table and the member of the message for it.
/// \param end  offset of the first of these members.
template <typename Table, typename Wire, typename Visit>
void for_each_member(const Table& fields, Wire& wire, std::size_t end, Visit visit) {
  using Byte = std::conditional_t<std::is_const_v<Wire>, const std::byte, std::byte>;
  Byte* const begin = reinterpret_cast<Byte*>(&wire);
  for_each_field(fields, [&]<typename Of, typename T>(const Field<Of, T>& field) {
    using Plain = typename WireMember<T>::Type;
    using Member = std::conditional_t<std::is_const_v<Wire>, const Plain, Plain>;
    const std::size_t place = place_after<Plain>(end);
    visit(field, *reinterpret_cast<Member*>(begin + place));
    end = place + sizeof(Plain);
  });
}

/// The size of a structure that ends with the fields of a table.
/// \param end  offset of the first of them.
template <typename Wire, typename Table>
constexpr std::size_t size_of_message(const Table& fields, std::size_t end) {
  for_each_field(fields, [&]<typename Of, typename T>(const Field<Of, T>&) {
    using Member = typename WireMember<T>::Type;
    end = place_after<Member>(end) + sizeof(Member);
  });
  return place_after<Wire>(end);
}

/// Two names.
using NamePair = std::pair<std::string, std::string>;

template <typename Wire>
requires requires(Wire wire) { wire.second; }
void write_part(const NamePair& names, Arena& arena, Wire& wire) {
  wire = {arena.text(names.first), arena.text(names.second)};
}

template <typename Wire>
requires requires(Wire wire) { wire.second; }
void read_part(const Wire& wire, Reader& /*reader*/, NamePair& names) {
  names = {read_text(wire.first), read_text(wire.second)};
}

template <Described Value, typename Wire>
void write_fields(const Value& value, Arena& arena, Wire& wire);
/// \param of  after a field's name in messages, e.g. " of a source".
template <Described Value, typename Wire>
Value read_fields(const Wire& wire, Reader& reader, const std::string& of = "");

/// A part of a value as a member of a message.
template <typename T, typename Wire>
void write_value(const T& from, const FieldRules& rules, Arena& arena, Wire& to) {
  if constexpr (requires { write_part(from, arena, to); }) {
    write_part(from, arena, to);
  } else if constexpr (Described<T>) {
    write_fields(from, arena, to);
  } else if constexpr (std::is_same_v<T, std::string>) {
    to = arena.text(from);
  } else if constexpr (std::is_same_v<T, Digest>) {
    write_digest(from, to);
  } else if constexpr (std::is_same_v<T, Uuid>) {
    write_uuid(from, to);
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    write_pose(from, to);
  } else if constexpr (std::is_same_v<T, std::optional<Digest>>) {
    if (from) {
      arena.resize(to, from->bytes.size());
      std::copy(from->bytes.begin(), from->bytes.end(), to._buffer);
    }
  } else if constexpr (std::is_same_v<T, std::optional<Eigen::Isometry3d>>) {
    write_placement(arena, from, to);
  } else if constexpr (kIsOptional<T>) {
    if (from) {
      arena.resize(to, 1);
      write_value(*from, rules, arena, to._buffer[0]);
    }
  } else if constexpr (kIsList<T>) {
    arena.resize(to, from.size());
    for (std::size_t i = 0; i < from.size(); ++i)
      write_value(from[i], rules, arena, to._buffer[i]);
  } else if constexpr (kIsDuration<T>) {
    const auto count = static_cast<double>(from.count());
    to = static_cast<std::uint32_t>(rules.is_clamped ? std::clamp(count, rules.min, rules.max)
                                                     : count);
  } else {
    to = static_cast<Wire>(from);
  }
}

/// The enumerator with the largest value that a field may have.
template <typename T>
T last_of(const FieldRules& rules) {
  if constexpr (requires { Words<T>::kWords.size(); })
    return static_cast<T>(std::min(static_cast<double>(kLastOf<T>), rules.max));
  else
    return static_cast<T>(rules.max);
}

/// Name of a member in messages.
struct MemberName {
  std::string_view field;
  std::string_view of = {};  ///< e.g. " of a source"

  std::string text() const { return std::string(field) + std::string(of); }
};

/// The part of a value that a member carries. Lists are counted before anything is allocated; texts
/// are as long as they came, which the check of the value finds.
template <typename T, typename Wire>
T read_value(const MemberName& name, const Wire& from, const FieldRules& rules, Reader& reader) {
  if constexpr (requires(T to) { read_part(from, reader, to); }) {
    T to;
    if constexpr (kIsMap<T>)
      reader.rules.at_most(name.text(), elements(from).size(), rules.limit);
    if (!reader.rules.broken())
      read_part(from, reader, to);
    return to;
  } else if constexpr (Described<T>) {
    return read_fields<T>(from, reader, " of " + name.text());
  } else if constexpr (std::is_same_v<T, std::string>) {
    return read_text(from);
  } else if constexpr (std::is_same_v<T, Digest>) {
    return read_digest(from);
  } else if constexpr (std::is_same_v<T, Uuid>) {
    return read_uuid(from);
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    return reader.pose(name.text(), from);
  } else if constexpr (std::is_same_v<T, std::optional<Digest>>) {
    return reader.optional_digest(name.text(), elements(from));
  } else if constexpr (std::is_same_v<T, std::optional<Eigen::Isometry3d>>) {
    return reader.placement(name.text(), elements(from));
  } else if constexpr (kIsOptional<T>) {
    const auto entries = elements(from);
    if (entries.empty())
      return std::nullopt;
    return read_value<typename T::value_type>(name, entries[0], rules, reader);
  } else if constexpr (kIsList<T>) {
    T to;
    reader.rules.at_most(name.text(), elements(from).size(), rules.limit);
    if (!reader.rules.broken())
      for (const auto& entry : elements(from))
        to.push_back(read_value<typename T::value_type>(name, entry, rules, reader));
    return to;
  } else if constexpr (std::is_enum_v<T>) {
    return reader.enumerator(name.text(), from, last_of<T>(rules));
  } else if constexpr (kIsDuration<T>) {
    return T(static_cast<typename T::rep>(
        rules.is_clamped ? std::min(static_cast<double>(from), rules.max) : from));
  } else {
    return static_cast<T>(from);
  }
}

/// Some fields of a value as the last members of a structure.
/// \param begin  offset of the first of them.
template <typename Value, typename Table, typename Wire>
void write_members(const Value& value, const Table& fields, std::size_t begin, Arena& arena,
                   Wire& wire) {
  for_each_member(fields, wire, begin, [&](const auto& field, auto& member) {
    write_value(value.*field.member, field.rules, arena, member);
  });
}

template <typename Value, typename Table, typename Wire>
void read_members(const Wire& wire, const Table& fields, std::size_t begin, Reader& reader,
                  Value& value, const std::string& of = "") {
  const auto read = [&]<typename Of, typename T>(const Field<Of, T>& field, const auto& member) {
    value.*field.member = read_value<T>({field.name, of}, member, field.rules, reader);
  };
  for_each_member(fields, wire, begin, read);
}

template <Described Value, typename Wire>
void write_fields(const Value& value, Arena& arena, Wire& wire) {
  static_assert(size_of_message<Wire>(kFieldsOf<Value>, head_bytes<Wire>()) == sizeof(Wire));
  write_members(value, kFieldsOf<Value>, head_bytes<Wire>(), arena, wire);
}

template <Described Value, typename Wire>
Value read_fields(const Wire& wire, Reader& reader, const std::string& of) {
  static_assert(size_of_message<Wire>(kFieldsOf<Value>, head_bytes<Wire>()) == sizeof(Wire));
  Value value;
  read_members(wire, kFieldsOf<Value>, head_bytes<Wire>(), reader, value, of);
  return value;
}

/// A check of a value, beyond what its reading finds.
template <typename Value>
using Check = std::optional<Error> (*)(const Value&);

/// The check of a value without rules between its fields.
template <Described Value>
std::optional<Error> validate_fields(const Value& value) {
  Rules rules;
  check_fields(value, rules);
  return rules.broken();
}

/// The message of a value with a table, if it fits into a sample.
template <typename Wire, Described Value>
Result<Message<Wire>> encode_fields(
    const Value& value, Message<Wire> message,
    std::type_identity_t<Check<Value>> check = validate_fields<Value>) {
  if (const auto error = check(value))
    return *error;
  write_fields(value, *message.arena, message.wire);
  return limited(std::move(message));
}

/// The value with a table that a message carries.
template <Described Value, typename Wire>
Result<Value> decode_fields(const Wire& wire, Check<Value> check = validate_fields<Value>) {
  Reader reader;
  Value value = read_fields<Value>(wire, reader);
  if (!reader.rules.broken())
    reader.rules.name(check(value));
  if (reader.rules.broken())
    return *reader.rules.broken();
  return value;
}

}  // namespace kinship::codec
