#include "proto/json/format.hpp"

#include <algorithm>

namespace kinship::json {

std::string to_text(const Format& format) {
  std::string name(format.name);
  std::ranges::replace(name, ' ', '-');
  return ("kinship." + name).append(format.ending) + "/" + std::to_string(format.version);
}

std::string in_format(const Format& format, std::string_view document) {
  constexpr std::string_view kBegin = "{\"format\":";
  if (document.starts_with(kBegin) || !document.starts_with('{'))
    return std::string(document);
  const std::string_view rest = document.substr(1);
  return std::string(kBegin) + '"' + to_text(format) + (rest == "}" ? "\"" : "\",") +
         std::string(rest);
}

}  // namespace kinship::json
