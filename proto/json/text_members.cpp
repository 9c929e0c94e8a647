#include "proto/json/text_members.hpp"

#include "proto/json/reader.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {

Result<std::map<std::string, std::string>> text_members_from_json(std::string_view text) {
  constexpr std::size_t kMaxMembers = 16;
  return read_document(text, "request", [](const Reader& root) {
    std::map<std::string, std::string> members;
    for (const std::string& name : root.keys(kMaxMembers))
      members[name] = root.at(name).text(kMaxTaskBytes);
    return members;
  });
}

}  // namespace kinship::json
