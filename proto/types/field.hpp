#pragma once

#include <chrono>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "proto/types/failure.hpp"

/// The description of each member of a value, given once: its name, its limits, and the format that
/// introduced it. JSON, messages, blobs, digests and checks use it.
namespace kinship {

struct FieldRules {
  double min = std::numeric_limits<double>::lowest();  ///< of a number
  double max = std::numeric_limits<double>::max();
  std::size_t limit = 0;          ///< bytes of a text, elements of a list or map
  std::size_t element_limit = 0;  ///< bytes of each text of a list
  /// A further check of a text, defined elsewhere.
  std::optional<Error> (*check)(std::string_view text) = nullptr;
  bool may_be_missing = false;  ///< in a JSON document
  bool is_clamped = false;      ///< a duration beyond its limits is taken to them in messages
  int since = 1;                ///< the first format of stored blobs that has it
  /// In a digest: left out if it has its default, else this word replaces it. Empty: its value is
  /// always included.
  std::string_view mark = {};

  constexpr bool has_bounds() const {
    return min > std::numeric_limits<double>::lowest() || max < std::numeric_limits<double>::max();
  }
};

template <typename Value, typename Member>
struct Field {
  using Type = Member;

  std::string_view name;
  Member Value::*member;
  FieldRules rules = {};
};
template <typename Value, typename Member>
Field(std::string_view, Member Value::*) -> Field<Value, Member>;
template <typename Value, typename Member>
Field(std::string_view, Member Value::*, FieldRules) -> Field<Value, Member>;

/// Rules of a number with limits.
constexpr FieldRules between(double min, double max) { return {.min = min, .max = max}; }

/// Rules of a field that was added later: files and blobs of older formats may lack it.
constexpr FieldRules since(int format) { return {.may_be_missing = true, .since = format}; }

/// The fields of a value: a tuple in the order of files and messages. New ones come last.
template <typename Value>
inline constexpr auto kFieldsOf = nullptr;

template <typename Value>
concept Described = !std::is_null_pointer_v<std::remove_const_t<decltype(kFieldsOf<Value>)>>;

template <typename T>
inline constexpr bool kIsOptional = false;
template <typename T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <typename T>
inline constexpr bool kIsList = false;
template <typename T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <typename T>
inline constexpr bool kIsMap = false;
template <typename Key, typename T>
inline constexpr bool kIsMap<std::map<Key, T>> = true;
template <typename T>
inline constexpr bool kIsDuration = false;
template <typename Count, typename Unit>
inline constexpr bool kIsDuration<std::chrono::duration<Count, Unit>> = true;

/// Calls visit(field) for each field of a table.
template <typename... Fields, typename Visit>
constexpr void for_each_field(const std::tuple<Fields...>& table, Visit visit) {
  std::apply([&visit](const auto&... field) { (visit(field), ...); }, table);
}

/// Calls visit(field) for each field of a value.
template <Described Value, typename Visit>
constexpr void for_each_field(Visit visit) {
  for_each_field(kFieldsOf<Value>, visit);
}

/// Whether each list of texts of a table limits the bytes of a text; else all texts are refused.
template <typename... Fields>
constexpr bool limits_listed_texts(const std::tuple<Fields...>& table) {
  bool limited = true;
  for_each_field(table, [&limited]<typename Of, typename T>(const Field<Of, T>& field) {
    if constexpr (std::is_same_v<T, std::vector<std::string>>)
      limited = limited && field.rules.element_limit > 0;
  });
  return limited;
}

/// The newest format that added a field of a table.
template <typename... Fields>
constexpr int newest_format(const std::tuple<Fields...>& table) {
  int newest = 1;
  for_each_field(table, [&newest](const auto& field) {
    newest = field.rules.since > newest ? field.rules.since : newest;
  });
  return newest;
}

}  // namespace kinship
