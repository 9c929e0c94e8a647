#include "server/store/values/prepared_attempt.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "proto/types/field_digest.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/sha256.hpp"
#include "server/store/values/search_blob.hpp"

namespace kinship::store {
namespace {

/// Integers of a database have a sign.
std::optional<std::string> reason_against(const PlanningRecord& record) {
  constexpr auto kLargest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  std::optional<std::string> reason;
  for_each_field<PlanningRecord>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    if constexpr (std::is_same_v<T, std::uint64_t>)
      if (!reason && record.*field.member > kLargest)
        reason = std::string(field.name) + " " + std::to_string(record.*field.member) +
                 " exceeds " + std::to_string(kLargest);
  });
  return reason;
}

Error refusal(const Attempt& attempt, const std::string& reason) {
  return {ErrorCode::InvalidInput, "attempt " + attempt.report_uuid.text() + ": " + reason};
}

double length_of(const Eigen::MatrixXd& waypoints) {
  const Eigen::Index segments = waypoints.cols() - 1;
  return (waypoints.rightCols(segments) - waypoints.leftCols(segments)).colwise().norm().sum();
}

/// A path is new by its waypoints and the cell of its placement. Waypoints alone would drop the
/// same motion at another placement, which passes through other poses of the task.
Digest content_digest(const Digest& waypoints,
                      const std::optional<Eigen::Isometry3d>& T_task_base) {
  Sha256 hash;
  hash.add(waypoints).add(std::uint64_t{T_task_base ? 1U : 0U});
  if (T_task_base) {
    const Eigen::MatrixXd placement = snapped(*T_task_base).matrix().topRows<3>();  // 3 x 4
    hash.add(placement);
  }
  return hash.finish();
}

Digest body_digest(const Attempt& attempt, const std::optional<PreparedPath>& path,
                   const std::optional<PreparedScene>& scene) {
  Sha256 hash;
  hash.add(attempt.robot).add(attempt.machine).add(attempt.task);
  hash.add(std::uint64_t{attempt.T_task_base ? 1U : 0U});
  if (attempt.T_task_base)
    for (const double number : to_pose_array(*attempt.T_task_base))
      hash.add(number);
  add_fields(attempt.record, hash);
  if (path)
    hash.add(path->waypoints);  // the placement is in it already, unsnapped
  if (scene)
    hash.add(scene->content);
  return hash.finish();
}

template <typename Reported, typename UuidOf>
std::vector<Uuid> uuids(const std::vector<Reported>& reported, UuidOf uuid_of) {
  std::vector<Uuid> uuids(reported.size());
  std::ranges::transform(reported, uuids.begin(), uuid_of);
  return uuids;
}

}  // namespace

std::vector<Uuid> report_uuids(const std::vector<Attempt>& attempts) {
  return uuids(attempts, [](const Attempt& attempt) { return attempt.report_uuid; });
}

std::vector<Uuid> report_uuids(const std::vector<ReplicatedReport>& reports) {
  return uuids(reports, [](const ReplicatedReport& report) { return report.attempt.report_uuid; });
}

Digest body_said_by(const PreparedAttempt& prepared, const std::string& machine) {
  Attempt said = prepared.attempt;
  said.machine = machine;
  return body_digest(said, prepared.path, prepared.scene);
}

Result<PreparedAttempt> prepare(Attempt attempt) {
  if (const std::optional<std::string> reason = reason_against(attempt.record))
    return refusal(attempt, *reason);
  std::optional<PreparedPath> path;
  if (attempt.path) {
    const Eigen::MatrixXd& waypoints = attempt.path->waypoints();
    const Digest digest = Sha256().add(waypoints).finish();
    path = PreparedPath{digest, content_digest(digest, attempt.T_task_base), length_of(waypoints),
                        encode_waypoints(waypoints)};
  }
  std::optional<PreparedScene> scene;
  if (attempt.scene)
    scene = PreparedScene{content_digest(*attempt.scene), encode_scene(*attempt.scene)};
  std::optional<PreparedSearch> search;
  if (attempt.search)
    search = PreparedSearch{why_text(*attempt.search), encode_search(*attempt.search)};
  const Digest body = body_digest(attempt, path, scene);
  attempt.path.reset();
  attempt.scene.reset();
  attempt.search.reset();
  return PreparedAttempt{.attempt = std::move(attempt),
                         .body = body,
                         .path = std::move(path),
                         .scene = std::move(scene),
                         .search = std::move(search),
                         .received_ms = {}};
}

Result<PreparedAttempt> prepare(ReplicatedReport report) {
  if (const std::optional<Error> error = validate(report.attempt))
    return refusal(report.attempt, error->message);
  Result<PreparedAttempt> result = prepare(std::move(report.attempt));
  if (!result)
    return result;
  PreparedAttempt prepared = std::move(result).value();
  prepared.body = report.body;
  prepared.received_ms = report.received_ms;
  prepared.is_retired = report.is_retired;
  return prepared;
}

}  // namespace kinship::store
