#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

/// Values as JSON by the tables of their fields; for the sources of this folder only.
namespace kinship::json {

template <typename T>
OrderedJson json_of(const T& value);
template <typename T>
T read_as(const Reader& reader, const FieldRules& rules = {});

/// Adds some fields of a value to an object.
/// \param fields  a tuple of Field.
template <typename Value, typename Table>
void add_members(const Value& value, const Table& fields, OrderedJson& object) {
  const auto add = [&](const auto& field) {
    object[std::string(field.name)] = json_of(value.*field.member);
  };
  std::apply([&](const auto&... field) { (add(field), ...); }, fields);
}

/// Reads some fields of a value from an object.
template <typename Value, typename Table>
void read_members(const Reader& reader, const Table& fields, Value& value) {
  const auto read = [&]<typename Of, typename T>(const Field<Of, T>& field) {
    if (!field.rules.may_be_missing && !kIsOptional<T>)
      value.*field.member = read_as<T>(reader.at(field.name), field.rules);
    else if (const auto found = reader.find(field.name))
      value.*field.member = read_as<T>(*found, field.rules);
    if constexpr (std::is_same_v<T, std::string>)
      if (const auto error =
              field.rules.check ? field.rules.check(value.*field.member) : std::nullopt)
        reader.refuse(error->message);
  };
  std::apply([&](const auto&... field) { (read(field), ...); }, fields);
}

/// An object with the fields of a value, in their order; a list; null for a missing optional; a
/// number, text or word.
template <typename T>
OrderedJson json_of(const T& value) {
  if constexpr (kIsOptional<T>) {
    return value ? json_of(*value) : OrderedJson(nullptr);
  } else if constexpr (kIsList<T>) {
    OrderedJson list = OrderedJson::array();
    for (const auto& element : value)
      list.push_back(json_of(element));
    return list;
  } else if constexpr (Described<T>) {
    OrderedJson object;
    add_members(value, kFieldsOf<T>, object);
    return object;
  } else if constexpr (std::is_enum_v<T>) {
    return to_text(value);
  } else if constexpr (std::is_same_v<T, Digest>) {
    return value.hex();
  } else if constexpr (std::is_same_v<T, Uuid>) {
    return value.text();
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    return pose_list(value);
  } else {
    return value;
  }
}

/// The value at a reader's place, within the limits of its field.
template <typename T>
T read_as(const Reader& reader, const FieldRules& rules) {
  if constexpr (kIsOptional<T>) {
    return read_as<typename T::value_type>(reader, rules);
  } else if constexpr (kIsList<T>) {
    T list;
    constexpr FieldRules kOfElement{.limit = kMaxMessageBytes};  // if it is a text
    for (const Reader& element : reader.elements(rules.limit))
      list.push_back(read_as<typename T::value_type>(element, kOfElement));
    return list;
  } else if constexpr (Described<T>) {
    T value;
    read_members(reader, kFieldsOf<T>, value);
    return value;
  } else if constexpr (std::is_enum_v<T>) {
    return parse_word<T>(reader.text(kMaxWordBytes)).value_or_throw();
  } else if constexpr (std::is_same_v<T, Digest>) {
    return reader.digest();
  } else if constexpr (std::is_same_v<T, Uuid>) {
    return reader.uuid();
  } else if constexpr (std::is_same_v<T, Eigen::Isometry3d>) {
    return reader.pose();
  } else if constexpr (std::is_same_v<T, std::string>) {
    return reader.text(rules.limit);
  } else if constexpr (std::is_same_v<T, bool>) {
    return reader.boolean();
  } else if constexpr (std::is_floating_point_v<T>) {
    return reader.number(rules.min, rules.max);
  } else if constexpr (std::is_unsigned_v<T>) {
    return static_cast<T>(reader.count(std::numeric_limits<T>::max()));
  } else {
    const std::int64_t number = reader.integer();
    if (rules.min == 0 && number < 0)
      reader.refuse(std::to_string(number) + " is negative");
    return number;
  }
}

/// A value as a part, or as the document of a format.
template <Described Value>
std::string write_fields(const Value& value) {
  return write(json_of(value));
}
template <Described Value>
std::string write_fields(const Value& value, const Format& format) {
  return write(format, json_of(value));
}

template <Described Value>
Result<Value> read_fields(std::string_view text, std::string_view what, const Format& format) {
  return read_document(text, what, format,
                       [](const Reader& reader) { return read_as<Value>(reader); });
}

}  // namespace kinship::json
