#pragma once

#include <cstdint>
#include <string_view>
#include <type_traits>

#include "proto/types/field.hpp"
#include "proto/types/sha256.hpp"

namespace kinship {

/// Adds a part of a value: counts, words and flags as 8 bytes, an optional after a flag.
template <typename T>
void add_value(const T& value, Sha256& hash) {
  if constexpr (kIsOptional<T>) {
    hash.add(std::uint64_t{value ? 1U : 0U});
    if (value)
      add_value(*value, hash);
  } else if constexpr (std::is_enum_v<T>) {
    hash.add(static_cast<std::uint64_t>(value));
  } else if constexpr (std::is_integral_v<T>) {
    hash.add(static_cast<std::uint64_t>(value));
  } else {
    hash.add(value);
  }
}

/// Adds the fields of a value in their order. A field with a mark is left out if it has its
/// default: so digests from before the field still hold.
template <Described Value>
void add_fields(const Value& value, Sha256& hash) {
  const Value usual;
  for_each_field<Value>([&](const auto& field) {
    if (field.rules.mark.empty())
      add_value(value.*field.member, hash);
    else if (value.*field.member != usual.*field.member)
      hash.add(field.rules.mark);
  });
}

}  // namespace kinship
