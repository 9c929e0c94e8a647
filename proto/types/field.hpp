#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "proto/types/failure.hpp"

/// What is said once of each member of a value: its name, its limits, and since when it is kept.
/// JSON, messages, blobs, digests and checks go by it.
namespace kinship {

struct FieldRules {
  double min = std::numeric_limits<double>::lowest();  ///< of a number
  double max = std::numeric_limits<double>::max();
  std::size_t limit = 0;  ///< bytes of a text, elements of a list
  /// What else is wrong with a text, if it is said elsewhere.
  std::optional<Error> (*check)(std::string_view text) = nullptr;
  bool may_be_missing = false;  ///< in a JSON document
  int since = 1;                ///< the format of stored blobs that had it first
  /// In a digest: left out where it has its default, else this word stands for it. Empty: its value
  /// is always in it.
  std::string_view mark = {};
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

/// Of a number with limits.
constexpr FieldRules between(double min, double max) { return {.min = min, .max = max}; }

/// Of a field that comes later: files may lack it, and blobs of older formats.
constexpr FieldRules since(int format) { return {.may_be_missing = true, .since = format}; }

/// The fields of a value: a tuple in the order in which files and messages have them. New ones come
/// last.
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

/// Calls visit(field) for each field of a value.
template <Described Value, typename Visit>
constexpr void for_each_field(Visit visit) {
  std::apply([&visit](const auto&... field) { (visit(field), ...); }, kFieldsOf<Value>);
}

/// The newest format that brought a field of the value.
template <Described Value>
constexpr int newest_format() {
  int newest = 1;
  for_each_field<Value>([&newest](const auto& field) {
    newest = field.rules.since > newest ? field.rules.since : newest;
  });
  return newest;
}

}  // namespace kinship
