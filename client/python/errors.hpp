#pragma once

#include <string>

#include "proto/types/result.hpp"

namespace kinship::python {

/// From now on what the libraries throw becomes an exception of kinship.errors with the same text;
/// a broken precondition (std::invalid_argument) becomes its InvalidInput.
void translate_failures();

/// Leaves for Python with an exception of kinship.errors. Needs the interpreter's lock.
/// \param name  of its class.
[[noreturn]] void raise_error(const char* name, const std::string& text);

/// Tells Python's `warnings`. Needs the interpreter's lock.
/// \param name  of a class of kinship.errors.
/// \throws the exception that the program has made of such warnings.
void warn(const char* name, const std::string& text);

}  // namespace kinship::python
