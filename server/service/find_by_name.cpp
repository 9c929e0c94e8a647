#include "server/service/find_by_name.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"

namespace kinship::service {
namespace {

constexpr std::size_t kMinPrefix = 4;
constexpr std::size_t kDigestDigits = 64;

bool is_hexadecimal(std::string_view text) {
  return !text.empty() &&
         text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

/// \return lower-case digits, or empty if `text` is no prefix of a digest.
std::string digest_prefix(std::string_view text) {
  if (text.size() < kMinPrefix || text.size() > kDigestDigits || !is_hexadecimal(text))
    return {};
  std::string prefix;
  for (const char c : text)
    prefix += c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
  return prefix;
}

bool begins_with(const Digest& digest, const std::string& prefix) {
  return digest.hex().compare(0, prefix.size(), prefix) == 0;
}

}  // namespace

Result<store::RobotRecord> find_robot(const store::Store& store, const std::string& name) {
  std::vector<store::RobotRecord> robots = store.robots();
  const auto labelled = std::find_if(robots.begin(), robots.end(), [&](const auto& robot) {
    return robot.description.label == name;
  });
  if (labelled != robots.end())
    return std::move(*labelled);
  const std::string prefix = digest_prefix(name);
  if (!prefix.empty())
    std::erase_if(robots, [&](const auto& robot) { return !begins_with(robot.digest, prefix); });
  if (prefix.empty() && name.size() < kMinPrefix && is_hexadecimal(name))
    return Error{ErrorCode::NotFound, not_found("robot", name).message +
                                          "; a prefix of a digest needs at least " +
                                          std::to_string(kMinPrefix) + " digits"};
  if (prefix.empty() || robots.empty())
    return not_found("robot", name);
  if (robots.size() == 1)
    return std::move(robots.front());
  return Error{ErrorCode::Conflict,
               "robot '" + name + "' could be '" + robots[0].description.label + "' (" +
                   robots[0].digest.short_hex() + ") or '" + robots[1].description.label + "' (" +
                   robots[1].digest.short_hex() + ")"};
}

Result<Digest> find_distribution_id(const store::Store& store, const std::string& name) {
  if (const std::optional<Digest> id = Digest::from_hex(name))
    return *id;
  const std::string prefix = digest_prefix(name);
  if (prefix.empty())
    return Error{ErrorCode::InvalidInput,
                 "'" + name + "' is not a prefix of a distribution's id: at least " +
                     std::to_string(kMinPrefix) + " hexadecimal digits"};
  std::optional<Digest> found;
  std::string cursor;
  do {
    const store::Page<DistributionSummary> page =
        store.list_distributions(std::nullopt, {}, cursor, kMaxPageRows);
    for (const DistributionSummary& summary : page.rows) {
      if (!begins_with(summary.id, prefix))
        continue;
      if (found)
        return Error{ErrorCode::Conflict, "distribution '" + name + "' could be " +
                                              found->short_hex() + " or " + summary.id.short_hex()};
      found = summary.id;
    }
    cursor = page.next_cursor;
  } while (!cursor.empty());
  if (!found)
    return not_found("distribution", name);
  return *found;
}

Error not_found(const std::string& what, const std::string& name) {
  return {ErrorCode::NotFound, "no " + what + " '" + name + "'"};
}

}  // namespace kinship::service
