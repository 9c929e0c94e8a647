#include "server/http/message.hpp"

#include <charconv>
#include <optional>

#include "proto/types/failure.hpp"

namespace kinship::http {
namespace {

/// \param plus_is_space  as in queries.
std::optional<std::string> decoded(std::string_view text, bool plus_is_space) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      plain += plus_is_space && text[i] == '+' ? ' ' : text[i];
      continue;
    }
    unsigned char byte = 0;
    const char* const digits = text.data() + i + 1;
    if (i + 2 >= text.size() || std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2)
      return std::nullopt;
    plain += static_cast<char>(byte);
    i += 2;
  }
  return plain;
}

/// The text before a letter, which goes with it; all of it without one.
std::string_view take_until(std::string_view& text, char letter) {
  const std::size_t end = text.find(letter);
  const std::string_view taken = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return taken;
}

}  // namespace

const std::string* Request::field(const std::string& name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? nullptr : &found->second;
}

std::string Request::query_value(const std::string& name) const {
  const auto found = query.find(name);
  return found == query.end() ? std::string() : found->second;
}

Result<Request> with_target(Request request, std::string_view target) {
  const Error wrong = invalid_input("the target is not a path");
  if (!target.starts_with('/'))
    return wrong;
  target = target.substr(0, target.find('#'));
  std::string_view query = target;
  request.path = take_until(query, '?');
  std::string_view path = request.path;
  path.remove_prefix(1);
  while (!path.empty()) {
    std::optional<std::string> part = decoded(take_until(path, '/'), false);
    if (!part)
      return wrong;
    request.parts.push_back(std::move(*part));
  }
  while (!query.empty()) {
    std::string_view value = take_until(query, '&');
    const std::optional<std::string> name = decoded(take_until(value, '='), true);
    std::optional<std::string> text = decoded(value, true);
    if (!name || !text)
      return wrong;
    request.query[*name] = std::move(*text);
  }
  return request;
}

std::string cookie_of(const Request& request, std::string_view name) {
  const std::string* const field = request.field("cookie");
  std::string_view rest = field == nullptr ? std::string_view() : *field;
  while (!rest.empty()) {
    std::string_view value = take_until(rest, ';');
    value.remove_prefix(std::min(value.find_first_not_of(' '), value.size()));
    if (take_until(value, '=') == name)
      return std::string(value);
  }
  return {};
}

Reply text_reply(unsigned status, std::string text) {
  return {.status = status, .body = std::move(text) + '\n'};
}

}  // namespace kinship::http
