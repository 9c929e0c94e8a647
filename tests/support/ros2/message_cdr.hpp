#pragma once

#include <rosidl_runtime_c/message_type_support_struct.h>

#include <cstdint>
#include <memory>
#include <vector>

/// Messages of rosidl's C generator as bytes, along its introspection, as rmw implementations do.
namespace kinship::test {

/// CDR in the byte order of this machine, behind the four bytes of its encapsulation.
/// \param type     of rosidl_typesupport_introspection_c.
/// \param message  a structure of that type.
std::vector<std::uint8_t> to_cdr(const rosidl_message_type_support_t* type, const void* message);

/// \param message  initialised. \throws std::runtime_error if the bytes end too early, or do not.
void from_cdr(const rosidl_message_type_support_t* type, const std::vector<std::uint8_t>& bytes,
              void* message);

/// Fills every member with a value of its own: lists and texts have three elements, or as many as
/// they may.
void fill(const rosidl_message_type_support_t* type, void* message);

}  // namespace kinship::test
