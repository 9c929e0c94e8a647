#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship {

/// Each check returns the fault of a name from outside, or nothing if it is valid. Tasks and
/// labels: 1 to 128 or 64 bytes of [A-Za-z0-9_.:-]. Machine and planner: printable UTF-8 without
/// control characters, up to 128 bytes, may be empty.
std::optional<Error> check_task(std::string_view task);
std::optional<Error> check_label(std::string_view label);
/// Name of a link or joint, called `what` in the message: up to kMaxLinkNameBytes, without control
/// characters, which a URDF can contain by references such as `&#27;`: names are written unchanged
/// to messages, logs and listings.
std::optional<Error> check_part_name(std::string_view what, std::string_view name);
/// A text from outside for a message: each control character, including line feeds, becomes '?'.
std::string on_one_line(std::string text);
std::optional<Error> check_machine(std::string_view machine);
std::optional<Error> check_planner(std::string_view planner);

/// Free text called `what` in the message: UTF-8 without control characters other than tab, line
/// feed and carriage return, at most `limit` bytes, may be empty.
std::optional<Error> check_text(std::string_view what, std::string_view text, std::size_t limit);

/// Whether the bytes are well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates).
bool is_utf8(std::string_view text) noexcept;

/// The start of a message, valid to send: at most `max_bytes`, whole UTF-8 characters; each byte
/// that is not UTF-8 and each control character that check_text() refuses becomes '?'.
std::string cut_text(std::string_view text, std::size_t max_bytes);

}  // namespace kinship
