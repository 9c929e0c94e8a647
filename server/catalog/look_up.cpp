#include "server/catalog/look_up.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "server/catalog/fetch_reply.hpp"
#include "server/catalog/freshness.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::catalog {
namespace {

/// Why a distribution of these robots cannot be fitted at all, or nothing.
std::optional<FetchReply> find_obstacle(const fitting::DistributionKey& key,
                                        runtime::RobotRegistry& robots) {
  if (const auto robot = robots.find(key.robot); !robot) {
    const Error& error = robot.error();
    if (error.code == ErrorCode::Storage)
      throw Failure(error);  // may pass
    return without_distribution(
        error.code == ErrorCode::NotFound ? FetchStatus::UnknownRobot : FetchStatus::Refused,
        error.message);
  }
  for (const Digest& source : key.sources)
    if (const auto robot = robots.find(source);
        !robot && robot.error().code == ErrorCode::NotFound)  // the fit tells of other problems
      return without_distribution(FetchStatus::Refused,
                                  "selected source: " + robot.error().message);
  return std::nullopt;
}

bool is_of_paths(const std::vector<store::ExperienceSummary>& all) {
  return std::ranges::any_of(all, [](const auto& robot) { return robot.paths > 0; });
}

}  // namespace

LookUp look_up(const Digest& id, const fitting::DistributionKey& key, const SharedReply& in_memory,
               const store::ExperienceStore& store, const store::DistributionStore& distributions,
               runtime::RobotRegistry& robots) {
  LookUp found;
  found.end = find_obstacle(key, robots);
  if (found.end)
    return found;
  found.known = in_memory;
  if (!found.known)
    if (std::optional<Distribution> stored = distributions.find_distribution(id)) {
      found.known = with_distribution(std::move(*stored));
      distributions.note_use(id);
    }
  // After the distribution: every retirement before this is known here.
  const std::vector<store::ExperienceSummary> all = store.experience(key.task);
  if (found.known && is_retired(*found.known->distribution, all))
    found.known = nullptr;
  found.experience = selected_experience(key, all);
  if (!found.known && fitting::count_paths(found.experience) == 0) {
    found.end = no_experience(key);
    found.has_no_paths = !is_of_paths(all);
  }
  return found;
}

}  // namespace kinship::catalog
