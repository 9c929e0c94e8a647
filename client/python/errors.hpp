#pragma once

#include <string>

#include "proto/types/result.hpp"

namespace kinship::python {

/// Registers the translation of the libraries' exceptions into those of kinship.errors with the
/// same text; a broken precondition (std::invalid_argument) becomes its InvalidInput.
void translate_failures();

/// Raises an exception of kinship.errors. Needs the interpreter's lock.
/// \param name  of its class.
[[noreturn]] void raise_error(const char* name, const std::string& text);

/// Issues a warning by Python's `warnings`. Needs the interpreter's lock.
/// \param name  of a class of kinship.errors.
/// \throws the warning as an exception, if the program's filters say so.
void warn(const char* name, const std::string& text);

}  // namespace kinship::python
