#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/codec/writer.hpp"
#include "proto/idl/report.h"
#include "proto/types/enum_text.hpp"
#include "proto/types/field.hpp"

/// Values as messages by the tables of their fields, for structures of the IDL that have the fields
/// of a value in the order of its table (tests/unit/proto/codec compares the names). For the
/// sources of this folder only.
namespace kinship::codec {

/// Type of a member in the structure that idlc generates.
template <typename T>
struct WireMember {
  using Type = std::conditional_t<std::is_enum_v<T> || std::is_same_v<T, int>, std::uint32_t, T>;
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
struct WireMember<std::optional<Digest>> {
  using Type = dds_sequence_octet;
};

/// Offset of a member after `end` bytes of others, as C lays out structures.
template <typename Type>
constexpr std::size_t place_after(std::size_t end) {
  return (end + alignof(Type) - 1) / alignof(Type) * alignof(Type);
}

/// Calls visit(field, member) for each field of a value and the member of the message for it.
template <Described Value, typename Wire, typename Visit>
void for_each_member(Wire& wire, Visit visit) {
  using Byte = std::conditional_t<std::is_const_v<Wire>, const std::byte, std::byte>;
  Byte* const begin = reinterpret_cast<Byte*>(&wire);
  std::size_t end = 0;
  for_each_field<Value>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    using Plain = typename WireMember<T>::Type;
    using Member = std::conditional_t<std::is_const_v<Wire>, const Plain, Plain>;
    const std::size_t place = place_after<Plain>(end);
    visit(field, *reinterpret_cast<Member*>(begin + place));
    end = place + sizeof(Plain);
  });
}

/// The size of a structure that has the fields of a value and nothing else.
template <Described Value>
constexpr std::size_t size_of_message() {
  std::size_t end = 0, alignment = 1;
  for_each_field<Value>([&]<typename Of, typename T>(const Field<Of, T>&) {
    using Member = typename WireMember<T>::Type;
    end = place_after<Member>(end) + sizeof(Member);
    alignment = alignof(Member) > alignment ? alignof(Member) : alignment;
  });
  return (end + alignment - 1) / alignment * alignment;
}

/// A list of values with fields as a sequence.
template <typename Value, typename Sequence>
void write_list(const std::vector<Value>& values, Arena& arena, Sequence& wire);
template <typename Value, typename Sequence>
std::vector<Value> read_list(const Sequence& wire, Reader& reader, const std::string& of = "");

/// The same, counted before anything is allocated.
template <typename Value, typename Sequence>
std::vector<Value> read_limited_list(const std::string& what, const Sequence& wire,
                                     std::size_t limit, Reader& reader) {
  reader.rules.at_most(what, elements(wire).size(), limit);
  if (reader.rules.broken())
    return {};
  return read_list<Value>(wire, reader, " of " + what);
}

template <Described Value, typename Wire>
void write_fields(const Value& value, Arena& arena, Wire& wire) {
  static_assert(size_of_message<Value>() == sizeof(Wire));
  const auto write = [&]<typename Of, typename T>(const Field<Of, T>& field, auto& member) {
    const T& from = value.*field.member;
    if constexpr (std::is_same_v<T, std::string>) {
      member = arena.text(from);
    } else if constexpr (std::is_same_v<T, Digest>) {
      write_digest(from, member);
    } else if constexpr (kIsList<T>) {
      write_list(from, arena, member);
    } else if constexpr (kIsOptional<T>) {
      if (from) {
        arena.resize(member, from->bytes.size());
        std::copy(from->bytes.begin(), from->bytes.end(), member._buffer);
      }
    } else {
      member = static_cast<std::decay_t<decltype(member)>>(from);
    }
  };
  for_each_member<Value>(wire, write);
}

/// The enumerator with the largest value that a field may have.
template <typename T>
T last_of(const FieldRules& rules) {
  return static_cast<T>(std::min(static_cast<double>(kLastOf<T>), rules.max));
}

/// \param of  after a field's name in messages, e.g. " of a source".
template <Described Value, typename Wire>
Value read_fields(const Wire& wire, Reader& reader, const std::string& of = "") {
  static_assert(size_of_message<Value>() == sizeof(Wire));
  Value value;
  const auto read = [&]<typename Of, typename T>(const Field<Of, T>& field, const auto& member) {
    const auto what = [&] { return std::string(field.name) + of; };
    T& to = value.*field.member;
    if constexpr (std::is_same_v<T, std::string>)
      to = reader.text(what(), member, field.rules.limit);
    else if constexpr (std::is_same_v<T, Digest>)
      to = read_digest(member);
    else if constexpr (kIsList<T>)
      to = read_limited_list<typename T::value_type>(what(), member, field.rules.limit, reader);
    else if constexpr (kIsOptional<T>)
      to = reader.optional_digest(what(), elements(member));
    else if constexpr (std::is_enum_v<T>)
      to = reader.enumerator(what(), member, last_of<T>(field.rules));
    else
      to = static_cast<T>(member);
  };
  for_each_member<Value>(wire, read);
  return value;
}

template <typename Value, typename Sequence>
void write_list(const std::vector<Value>& values, Arena& arena, Sequence& wire) {
  arena.resize(wire, values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    write_fields(values[i], arena, wire._buffer[i]);
}

template <typename Value, typename Sequence>
std::vector<Value> read_list(const Sequence& wire, Reader& reader, const std::string& of) {
  std::vector<Value> values;
  for (const auto& entry : elements(wire))
    values.push_back(read_fields<Value>(entry, reader, of));
  return values;
}

/// An optional value as a sequence of one element or none.
template <typename Value, typename Sequence>
void write_optional(const std::optional<Value>& value, Arena& arena, Sequence& wire) {
  if (value)
    write_list(std::vector{*value}, arena, wire);
}

template <typename Value, typename Sequence>
std::optional<Value> read_optional(const Sequence& wire, Reader& reader,
                                   const std::string& of = "") {
  const auto entries = elements(wire);
  if (entries.empty())
    return std::nullopt;
  return read_fields<Value>(entries[0], reader, of);
}

}  // namespace kinship::codec
