#include "proto/types/names.hpp"

#include <algorithm>
#include <string>

#include "proto/types/limits.hpp"

namespace kinship {
namespace {

bool is_name_character(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '.' || c == ':' || c == '-';
}

bool is_control_character(char c) {
  return static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) == 0x7F;
}

bool is_control_character_in_text(char c) {
  return is_control_character(c) && c != '\t' && c != '\n' && c != '\r';
}

/// Length of the well-formed UTF-8 sequence at the start of `text`; 0 if there is none.
std::size_t utf8_length(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  if (byte(0) < 0x80)
    return 1;
  if (byte(0) < 0xC2 || byte(0) > 0xF4)
    return 0;
  const std::size_t length = byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (text.size() < length)
    return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0U) != 0x80U)
      return 0;
  if (byte(0) == 0xE0 && byte(1) < 0xA0)
    return 0;  // overlong
  if (byte(0) == 0xED && byte(1) > 0x9F)
    return 0;  // surrogates
  if (byte(0) == 0xF0 && byte(1) < 0x90)
    return 0;  // overlong
  if (byte(0) == 0xF4 && byte(1) > 0x8F)
    return 0;  // above U+10FFFF
  return length;
}

std::optional<Error> check_length(std::string_view what, std::string_view text, std::size_t limit) {
  if (text.size() <= limit)
    return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + ": " + std::to_string(text.size()) +
                                            " bytes exceed " + std::to_string(limit)};
}

std::optional<Error> check_name(std::string_view what, std::string_view text, std::size_t limit) {
  if (text.empty())
    return Error{ErrorCode::InvalidInput, std::string(what) + ": is empty"};
  if (auto error = check_length(what, text, limit))
    return error;
  const auto bad = std::find_if_not(text.begin(), text.end(), is_name_character);
  if (bad == text.end())
    return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + ": byte " +
                                            std::to_string(bad - text.begin() + 1) +
                                            " is not one of A-Z a-z 0-9 _ . : -"};
}

std::optional<Error> check_free_text(std::string_view what, std::string_view text,
                                     std::size_t limit, bool (*is_refused)(char)) {
  if (auto error = check_length(what, text, limit))
    return error;
  if (!is_utf8(text))
    return Error{ErrorCode::InvalidInput, std::string(what) + ": is not UTF-8"};
  const auto bad = std::find_if(text.begin(), text.end(), is_refused);
  if (bad == text.end())
    return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + ": byte " +
                                            std::to_string(bad - text.begin() + 1) +
                                            " is a control character"};
}

}  // namespace

std::optional<Error> check_task(std::string_view task) {
  return check_name("task", task, kMaxTaskBytes);
}

std::optional<Error> check_label(std::string_view label) {
  return check_name("label", label, kMaxLabelBytes);
}

std::optional<Error> check_part_name(std::string_view what, std::string_view name) {
  if (name.size() > kMaxLinkNameBytes)
    return Error{ErrorCode::InvalidInput, std::string(what) + ": name of " +
                                              std::to_string(name.size()) + " bytes exceeds " +
                                              std::to_string(kMaxLinkNameBytes)};
  const auto bad = std::find_if(name.begin(), name.end(), is_control_character);
  if (bad == name.end())
    return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + " '" + on_one_line(std::string(name)) +
                                            "': byte " + std::to_string(bad - name.begin() + 1) +
                                            " of the name is a control character"};
}

std::string on_one_line(std::string text) {
  std::replace_if(text.begin(), text.end(), is_control_character, '?');
  return text;
}

std::optional<Error> check_machine(std::string_view machine) {
  return check_free_text("machine", machine, kMaxMachineBytes, is_control_character);
}

std::optional<Error> check_planner(std::string_view planner) {
  return check_free_text("planner", planner, kMaxPlannerBytes, is_control_character);
}

std::optional<Error> check_text(std::string_view what, std::string_view text, std::size_t limit) {
  return check_free_text(what, text, limit, is_control_character_in_text);
}

bool is_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0)
      return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string cut_text(std::string_view text, std::size_t max_bytes) {
  std::string cut;
  while (!text.empty()) {
    const std::size_t known = utf8_length(text);
    const std::size_t length = known == 0 ? 1 : known;
    if (cut.size() + length > max_bytes)
      break;
    if (known == 0 || is_control_character_in_text(text.front())) {
      cut += '?';
    } else {
      cut += text.substr(0, length);
    }
    text.remove_prefix(length);
  }
  return cut;
}

}  // namespace kinship
