#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <string>

#include "client/c/kinship.h"
#include "proto/types/failure.hpp"

namespace kinship::c_library {

/// Returns the code of an error and keeps its text for kinship_error_text().
kinship_code remember(kinship_code code, const std::string& text) noexcept;
kinship_code remember(const Error& error) noexcept;

/// Runs the body of a function of the C library: exceptions become a code and a text.
kinship_code guarded(const std::function<kinship_code()>& body) noexcept;

/// \throws Failure(InvalidInput) that names the argument if it is NULL.
void require(const void* argument, const char* name);

/// A caller's structure in this version's layout: members that the caller's version lacks are 0.
/// \throws Failure(InvalidInput) if it is NULL or has an impossible size.
template <typename Structure>
Structure read_structure(const Structure* given, const char* name) {
  require(given, name);
  constexpr std::size_t kMaxSize = 4096;
  std::size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  if (size < sizeof size || size > kMaxSize)
    throw Failure(invalid_input(std::string(name) + ": its size is " + std::to_string(size) +
                                ", must be what sizeof says"));
  Structure known{};
  std::memcpy(&known, given, size < sizeof known ? size : sizeof known);
  return known;
}

/// Writes a caller's structure up to its size, which does not change.
/// \throws Failure(InvalidInput) as read_structure().
template <typename Structure>
void write_structure(Structure values, Structure* into, const char* name) {
  values.size = read_structure(into, name).size;
  std::memcpy(into, &values, values.size < sizeof values ? values.size : sizeof values);
}

}  // namespace kinship::c_library
