#include "server/service/find_by_name.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/nearest_name.hpp"
#include "server/catalog/nearest_task.hpp"

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

Result<RobotSummary> find_robot(const store::RobotStore& store, const std::string& name) {
  const std::string prefix = digest_prefix(name);
  std::vector<RobotSummary> alike;  // by their digest, the first two
  std::vector<std::string> labels;
  std::string cursor;
  do {
    store::Page<RobotSummary> page = store.list_robots(cursor, kMaxPageRows);
    for (RobotSummary& robot : page.rows) {
      if (robot.label == name)
        return std::move(robot);
      if (!prefix.empty() && alike.size() < 2 && begins_with(robot.robot, prefix))
        alike.push_back(std::move(robot));
      else
        labels.push_back(std::move(robot.label));
    }
    cursor = page.next_cursor;
  } while (!cursor.empty());
  if (prefix.empty() && name.size() < kMinPrefix && is_hexadecimal(name))
    return Error{ErrorCode::NotFound, not_found("robot", name).message +
                                          "; a prefix of a digest needs at least " +
                                          std::to_string(kMinPrefix) + " digits"};
  if (alike.empty())
    return Error{ErrorCode::NotFound, not_found("robot", name).message + suggestion(name, labels)};
  if (alike.size() == 1)
    return std::move(alike.front());
  return Error{ErrorCode::Conflict, "robot '" + name + "' could be '" + alike[0].label + "' (" +
                                        alike[0].robot.short_hex() + ") or '" + alike[1].label +
                                        "' (" + alike[1].robot.short_hex() + ")"};
}

Result<Digest> find_distribution_id(const store::DistributionStore& store,
                                    const std::string& name) {
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

std::vector<Uuid> reports_like(const store::ExperienceStore& store, const std::string& text,
                               std::size_t limit) {
  constexpr std::string_view kFirst = "00000000-0000-0000-0000-000000000000";
  constexpr std::string_view kLast = "ffffffff-ffff-ffff-ffff-ffffffffffff";
  constexpr std::size_t kMinUuidPrefix = 8;
  const std::size_t length = text.size();
  const auto first =
      Uuid::parse(length < kFirst.size() ? text + std::string(kFirst.substr(length)) : text);
  if (length < kMinUuidPrefix || !first)
    throw Failure(ErrorCode::InvalidInput,
                  "'" + text + "' is not a report's UUID, nor a prefix of at least " +
                      std::to_string(kMinUuidPrefix) + " of its digits");
  const auto last = Uuid::parse(text + std::string(kLast.substr(length)));
  return store.reports_between(*first, *last, limit);
}

Uuid report_of(const store::ExperienceStore& store, const std::string& text) {
  if (const std::optional<Uuid> report = Uuid::parse(text))
    return *report;
  const std::vector<Uuid> reports = reports_like(store, text, 2);
  if (reports.empty())
    throw Failure(not_found("report", text));
  if (reports.size() > 1)
    throw Failure(ErrorCode::InvalidInput,
                  "several reports begin with '" + text + "': more digits of the UUID, please");
  return reports.front();
}

Error no_task(const store::ExperienceStore& store, const std::string& task) {
  return {ErrorCode::NotFound, not_found("task", task).message +
                                   catalog::nearest_task(store, task, catalog::Of::AllTasks)};
}

Error not_found(const std::string& what, const std::string& name) {
  return {ErrorCode::NotFound, "no " + what + " '" + name + "'"};
}

}  // namespace kinship::service
