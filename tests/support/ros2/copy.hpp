#pragma once

#include <rosidl_runtime_c/string.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <type_traits>
#include <vector>

/// Parts of copies.hpp, which rosidl's structures and idlc's have of each type. Texts and numbers
/// of lists are borrowed; memory of lists of structures stays until the process ends.

inline void* zeros_for_good(std::size_t count, std::size_t size) {
  static std::vector<std::unique_ptr<void, decltype(&std::free)>> kept;
  return kept.emplace_back(std::calloc(count, size), &std::free).get();
}

template <typename Number>
requires std::is_arithmetic_v<Number>
void copy(const Number& from, Number& to) { to = from; }

inline void copy(const rosidl_runtime_c__String& from, char*& to) { to = from.data; }

template <typename From, typename To, std::size_t kSize>
void copy(const From (&from)[kSize], To (&to)[kSize]) {
  for (std::size_t i = 0; i < kSize; ++i)
    copy(from[i], to[i]);
}

template <typename From, typename To>
requires requires(From from, To to) {
  from.capacity;
  to._buffer;
}
void copy(const From& from, To& to) {
  using Element = std::remove_pointer_t<decltype(to._buffer)>;
  to._length = to._maximum = static_cast<std::uint32_t>(from.size);
  to._buffer = static_cast<Element*>(zeros_for_good(from.size, sizeof(Element)));
  for (std::size_t i = 0; i < from.size; ++i)
    copy(from.data[i], to._buffer[i]);
}
