#include "server/app/password.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <string_view>

namespace kinship::app {
namespace {

/// Erases from the first colon of a part to its last '@'.
bool erase_password(std::string& url, std::size_t begin, std::size_t end) {
  const std::size_t at = url.find_last_of('@', end);
  if (at == std::string::npos || at < begin)
    return false;
  if (const std::size_t colon = url.find(':', begin); colon < at)
    url.erase(colon, at - colon);
  return true;
}

/// %70 is a p.
std::string decode(std::string_view text) {
  std::string decoded;
  constexpr std::size_t kCodeSize = 3;
  constexpr int kHexadecimal = 16;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%' || i + kCodeSize > text.size()) {
      decoded += text[i];
      continue;
    }
    const std::string code(text.substr(i + 1, kCodeSize - 1));
    decoded += static_cast<char>(std::strtol(code.c_str(), nullptr, kHexadecimal));
    i += kCodeSize - 1;
  }
  return decoded;
}

bool is_password(std::string_view parameter) {
  std::string name = decode(parameter.substr(0, parameter.find('=')));
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name.find("password") != std::string::npos;
}

/// \param parameters  "a=1&b=2"
std::string without_secrets(std::string_view parameters) {
  std::string kept;
  while (!parameters.empty()) {
    const std::size_t end = std::min(parameters.find('&'), parameters.size());
    const std::string_view parameter = parameters.substr(0, end);
    if (!is_password(parameter))
      kept += (kept.empty() ? "" : "&") + std::string(parameter);
    parameters.remove_prefix(std::min(end + 1, parameters.size()));
  }
  return kept;
}

}  // namespace

std::string without_password(const std::string& text) {
  constexpr std::string_view kSeparator = "://";
  const std::size_t scheme = text.find(kSeparator);
  if (scheme == std::string::npos)
    return text;
  const std::size_t begin = scheme + kSeparator.size();
  std::string url = text;
  // User and host end at a slash; a password with a slash, which should be written %2F, goes, too.
  if (!erase_password(url, begin, url.find('/', begin)))
    erase_password(url, begin, url.find('?', begin));
  const std::size_t query = url.find('?', begin);
  if (query == std::string::npos)
    return url;
  const std::string parameters = without_secrets(std::string_view(url).substr(query + 1));
  return url.substr(0, query) + (parameters.empty() ? "" : "?" + parameters);
}

std::string without_passwords_of(std::span<const char* const> arguments, std::string text) {
  for (const std::string argument : arguments) {
    const std::string shown = without_password(argument);
    if (shown == argument)
      continue;
    for (std::size_t at = text.find(argument); at != std::string::npos;
         at = text.find(argument, at + shown.size()))
      text.replace(at, argument.size(), shown);
  }
  return text;
}

}  // namespace kinship::app
