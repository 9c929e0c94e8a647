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

std::optional<Error> check_length(std::string_view what, std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + ": " + std::to_string(text.size()) +
                                            " bytes exceed " + std::to_string(limit)};
}

std::optional<Error> check_name(std::string_view what, std::string_view text, std::size_t limit) {
  if (text.empty()) return Error{ErrorCode::InvalidInput, std::string(what) + ": is empty"};
  if (auto error = check_length(what, text, limit)) return error;
  const auto bad = std::find_if_not(text.begin(), text.end(), is_name_character);
  if (bad == text.end()) return std::nullopt;
  return Error{ErrorCode::InvalidInput, std::string(what) + ": byte " +
                                            std::to_string(bad - text.begin() + 1) +
                                            " is not one of A-Z a-z 0-9 _ . : -"};
}

std::optional<Error> check_free_text(std::string_view what, std::string_view text,
                                     std::size_t limit) {
  if (auto error = check_length(what, text, limit)) return error;
  const auto bad = std::find_if(text.begin(), text.end(), is_control_character);
  if (bad == text.end()) return std::nullopt;
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

std::optional<Error> check_machine(std::string_view machine) {
  return check_free_text("machine", machine, kMaxMachineBytes);
}

std::optional<Error> check_planner(std::string_view planner) {
  return check_free_text("planner", planner, kMaxPlannerBytes);
}

}  // namespace kinship
