#pragma once

#include <vector>

#include "tests/support/store_values.hpp"

/// What the stores of this folder hold. Once a schema is released never edited: its file is not
/// written again.
namespace kinship::test {

inline const std::vector<store::RobotRecord>& golden_robots() {
  static const std::vector<store::RobotRecord> kRobots = {make_robot("iiwa", 2),
                                                          make_robot("panda", 1)};
  return kRobots;
}

/// Of attempt 4, in schemas that have search records.
inline SearchRecord golden_search_record() {
  SearchRecord search;
  search.start = Eigen::VectorXd::Constant(kDof, 0.25);
  search.goals = Eigen::MatrixXd::Constant(kDof, 2, 0.5);
  search.blockers = {{"arm", "shelf", 60}};
  search.reason = "not solved within 10 s";
  return search;
}

/// For robot 0 and 1 in turn, tasks "bin" and "shelf"; number 4 is not solved, number 5 has no
/// placement, number 6 is long and smooth, so that it is compressed.
inline std::vector<Attempt> golden_attempts() {
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 0; number < 8; ++number) {
    const Digest& robot = golden_robots()[number % 2].digest;
    const char* const task = number < 6 ? "shelf" : "bin";
    attempts.push_back(number == 4 ? make_unsolved(robot, task, number)
                                   : make_attempt(robot, task, number));
  }
  attempts[4].search = golden_search_record();
  attempts[5].T_task_base.reset();
  Eigen::MatrixXd line(kDof, 200);
  for (Eigen::Index i = 0; i < line.cols(); ++i)
    line.col(i).setConstant(0.001 * static_cast<double>(i));
  attempts[6].path = Path(line);
  return attempts;
}

/// Retired; the only one of its task, which is removed in schemas that have removed tasks.
inline Attempt golden_retired_attempt() {
  return make_attempt(golden_robots()[0].digest, "drawer", 8);
}

/// The content of the retired one, and the number of a report that another store retired before it
/// came.
inline Attempt golden_same_content() {
  Attempt attempt = golden_retired_attempt();
  attempt.report_uuid = id_from<Uuid>(40);
  return attempt;
}
inline constexpr std::uint64_t kGoldenRetiredBefore = 41;

/// The only ones of their task. Their scene is one.
inline std::vector<Attempt> golden_attempts_with_scene() {
  std::vector<Attempt> attempts = {make_attempt(golden_robots()[1].digest, "table", 20),
                                   make_attempt(golden_robots()[1].digest, "table", 21)};
  for (Attempt& attempt : attempts)
    attempt.scene = RecordedScene{{{"table", BoxShape{{1, 2, 0.1}}},
                                   {"cup", CylinderShape{0.04, 0.1}, make_pose()},
                                   {"ball", SphereShape{0.1}},
                                   {"pipe", CapsuleShape{0.02, 0.5}, make_pose()}},
                                  {{"can", CylinderShape{0.03, 0.1}, make_pose()}},
                                  {{"can", "table"}}};
  return attempts;
}

/// The only ones of their task, which kept two of them.
inline std::vector<Attempt> golden_capped_attempts() {
  std::vector<Attempt> attempts;
  for (std::uint64_t number = 30; number < 35; ++number)
    attempts.push_back(make_attempt(golden_robots()[0].digest, "tray", number));
  return attempts;
}
inline constexpr std::uint64_t kGoldenCap = 2;

/// Taken over for robot 0.
inline MeshSolids golden_mesh_solids() {
  return {{{"hand", BoxShape{{0.1, 0.2, 0.05}}, make_pose()}, {"arm", CapsuleShape{0.06, 0.4}}},
          {{"arm", "hand"}}};
}

/// Of robot 0, in schemas that have meshes.
inline TriangleMesh golden_mesh() {
  Eigen::Matrix3Xd corners(3, 6);
  corners << 0, 1, 0, 0, 0, 1, 0, 0, 0.5, 0, 0, 0, 0, 0, 0, 0, 0.25, 0.25;
  return TriangleMesh::from_corners(corners).value_or_throw();
}
inline std::vector<LinkMesh> golden_link_meshes() {
  return {
      {"hand", MeshRole::Visual, make_pose(), {1, 0.5, 0.25, 1}, 0.001, golden_mesh().digest()}};
}

/// Kept after the entries of the retirement and the eviction.
inline AuditEntry golden_audit_entry() {
  AuditEntry entry;
  entry.name = "anna";
  entry.role = "operator";
  entry.client = "anna";
  entry.is_local = false;
  entry.verb = "reset_task";
  entry.target = "shelf";
  entry.outcome = AuditOutcome::Refused;
  entry.message = "anna (role reader) may not reset tasks: needs role operator";
  return entry;
}

/// Evicted after one fit.
inline Distribution golden_evicted_distribution() {
  return make_distribution(golden_robots()[1].digest, "bin", 101);
}

inline Distribution golden_distribution() {
  return make_distribution(golden_robots()[0].digest, "shelf", 100);
}

inline store::StoredRehearsal golden_rehearsal() {
  return make_rehearsal(golden_robots()[0].digest, "shelf", 100);
}

}  // namespace kinship::test
