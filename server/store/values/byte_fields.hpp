#pragma once

#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

#include "proto/types/enum_text.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"
#include "server/store/values/byte_stream.hpp"

/// Values as bytes by the tables of their fields.
namespace kinship::store {

constexpr std::size_t kMaxTextBytes = 1'000'000;

template <typename Value, typename Table>
void add_members(ByteWriter& out, const Value& value, const Table& fields);

/// Appends a value: integers of every width as 8 bytes, ids as they are, lists after their size,
/// optional values after a flag.
template <typename T>
void add_value(ByteWriter& out, const T& value) {
  if constexpr (std::is_same_v<T, std::optional<Eigen::Isometry3d>>) {
    out.add(value);
  } else if constexpr (kIsOptional<T>) {
    out.add(std::uint64_t{value ? 1U : 0U});
    if (value)
      add_value(out, *value);
  } else if constexpr (kIsList<T>) {
    out.add(std::uint64_t{value.size()});
    for (const auto& element : value)
      add_value(out, element);
  } else if constexpr (Described<T>) {
    add_members(out, value, kFieldsOf<T>);
  } else if constexpr (std::is_same_v<T, Digest>) {
    out.add(std::span<const std::uint8_t>(value.bytes));
  } else if constexpr (std::is_same_v<T, Eigen::Matrix2Xd>) {
    out.add(Eigen::MatrixXd(value));
  } else if constexpr (std::is_enum_v<T> || std::is_integral_v<T>) {
    out.add(static_cast<std::uint64_t>(value));
  } else {
    out.add(value);  // a number or a text
  }
}

/// \param fields  a tuple of Field.
template <typename Value, typename Table>
void add_members(ByteWriter& out, const Value& value, const Table& fields) {
  std::apply([&](const auto&... field) { (add_value(out, value.*field.member), ...); }, fields);
}

template <typename Value, typename Table>
void read_members(ByteReader& in, int format, const Table& fields, Value& value);

/// \param format  of the blob: fields of later formats are not in it and keep their defaults.
/// \throws std::out_of_range if the bytes are no value of this type.
template <typename T>
T read_value(ByteReader& in, int format, const FieldRules& rules = {}) {
  if constexpr (std::is_same_v<T, std::optional<Eigen::Isometry3d>>) {
    return in.pose();
  } else if constexpr (kIsOptional<T>) {
    if (in.integer() == 0)
      return std::nullopt;
    return read_value<typename T::value_type>(in, format, rules);
  } else if constexpr (kIsList<T>) {
    const std::uint64_t size = in.integer();
    if (size > rules.limit)
      throw std::out_of_range("blob: list of " + std::to_string(size));
    T list;
    for (std::uint64_t i = 0; i < size; ++i)
      list.push_back(read_value<typename T::value_type>(in, format));
    return list;
  } else if constexpr (Described<T>) {
    T value;
    read_members(in, format, kFieldsOf<T>, value);
    return value;
  } else if constexpr (std::is_same_v<T, Digest>) {
    T value;
    in.bytes(value.bytes);
    return value;
  } else if constexpr (std::is_same_v<T, Eigen::Matrix2Xd>) {
    const Eigen::MatrixXd values = in.matrix(2, rules.limit);
    if (values.rows() != 2)
      throw std::out_of_range("blob: " + std::to_string(values.rows()) + " rows instead of 2");
    return values;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return in.text(kMaxTextBytes);
  } else if constexpr (std::is_enum_v<T>) {
    const std::uint64_t value = in.integer();
    if (value > static_cast<std::uint64_t>(kLastOf<T>))
      throw std::out_of_range("blob: enumerator " + std::to_string(value));
    return static_cast<T>(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return in.real();
  } else {
    const std::uint64_t value = in.integer();
    if (sizeof(T) < sizeof value &&
        value > static_cast<std::uint64_t>(std::numeric_limits<T>::max()))
      throw std::out_of_range("blob: number " + std::to_string(value));
    return static_cast<T>(value);
  }
}

template <typename Value, typename Table>
void read_members(ByteReader& in, int format, const Table& fields, Value& value) {
  const auto read = [&]<typename Of, typename T>(const Field<Of, T>& field) {
    if (format >= field.rules.since)
      value.*field.member = read_value<T>(in, format, field.rules);
  };
  std::apply([&](const auto&... field) { (read(field), ...); }, fields);
}

}  // namespace kinship::store
