#pragma once

#include <span>
#include <string>

namespace kinship::app {

/// A URL without its passwords, for people: without the part behind the user's name, and without
/// parameters that are named like a password. In doubt it leaves out more. Any other text is
/// returned unchanged.
std::string without_password(const std::string& text);

/// A text about a command line, without the passwords of the URLs in it.
std::string without_passwords_of(std::span<const char* const> arguments, std::string text);

}  // namespace kinship::app
