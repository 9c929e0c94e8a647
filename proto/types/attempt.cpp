#include "proto/types/attempt.hpp"

#include "proto/types/rules.hpp"

namespace kinship {

BatchBytes batch_bytes(const Attempt& attempt) {
  BatchBytes bytes;
  if (attempt.path)
    bytes.waypoints = sizeof(double) * static_cast<std::size_t>(attempt.path->waypoints().size());
  if (attempt.scene)
    bytes.scenes = scene_bytes(*attempt.scene);
  if (attempt.search)
    bytes.searches = search_bytes(*attempt.search);
  return bytes;
}

std::optional<Error> validate(const Attempt& attempt) {
  Rules rules;
  rules.that(attempt.report_uuid != Uuid{}, "report_uuid: is zero")
      .name(check_machine(attempt.machine))
      .name(check_task(attempt.task));
  if (attempt.T_task_base)
    rules.pose("T_task_base", *attempt.T_task_base);
  check_fields(attempt.record, rules);
  rules.that(
      attempt.path.has_value() == (attempt.record.outcome == Outcome::Solved),
      attempt.path ? "waypoints: given although not solved" : "waypoints: missing although solved");
  if (attempt.path)
    rules.at_most("dof", static_cast<std::size_t>(attempt.path->dof()), kMaxDof)
        .at_most("waypoints", static_cast<std::size_t>(attempt.path->size()), kMaxWaypoints)
        .at_most("waypoints (bytes)", batch_bytes(attempt).waypoints, kMaxBatchBytes);
  if (attempt.scene)
    rules.name(check_scene(*attempt.scene));
  if (attempt.search) {
    const Eigen::Index dof = dof_of(*attempt.search);
    const BatchBytes bytes = batch_bytes(attempt);
    rules.name(check_search(*attempt.search))
        .that(!attempt.path || dof == 0 || dof == attempt.path->dof(),
              "search: has " + std::to_string(dof) + " joints, the path another number")
        .at_most("waypoints and search (bytes)", bytes.waypoints + bytes.searches, kMaxBatchBytes);
  }
  return rules.broken();
}

}  // namespace kinship
