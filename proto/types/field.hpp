#pragma once

#include <cstddef>
#include <limits>
#include <optional>
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
  std::size_t limit = 0;  ///< bytes of a text, elements of a list
  /// A further check of a text, defined elsewhere.
  std::optional<Error> (*check)(std::string_view text) = nullptr;
  bool may_be_missing = false;  ///< in a JSON document
  int since = 1;                ///< the first format of stored blobs that has it
  /// In a digest: left out if it has its default, else this word replaces it. Empty: its value is
  /// always included.
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

/// Calls visit(field) for each field of a value.
template <Described Value, typename Visit>
constexpr void for_each_field(Visit visit) {
  std::apply([&visit](const auto&... field) { (visit(field), ...); }, kFieldsOf<Value>);
}

/// The newest format that added a field of the value.
template <Described Value>
constexpr int newest_format() {
  int newest = 1;
  for_each_field<Value>([&newest](const auto& field) {
    newest = field.rules.since > newest ? field.rules.since : newest;
  });
  return newest;
}

}  // namespace kinship
