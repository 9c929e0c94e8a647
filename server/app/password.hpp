#pragma once

#include <span>
#include <string>

namespace kinship::app {

/// A URL without the passwords that are in it, for people: without what stands behind the user's
/// name, and without parameters that are called like one. In doubt it leaves out more. Another text
/// is as it was.
std::string without_password(const std::string& text);

/// What is said about a command line, without the passwords of its URLs.
std::string without_passwords_of(std::span<const char* const> arguments, std::string text);

}  // namespace kinship::app
