#include "client/cli/foreign_paths.hpp"

#include <algorithm>
#include <map>
#include <ostream>
#include <set>
#include <utility>

#include "client/cli/attempt_delivery.hpp"
#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "client/guided/scene_record.hpp"
#include "client/link/admin_rows.hpp"
#include "client/moveit/warehouse.hpp"
#include "client/ompl/planner_data.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/names.hpp"
#include "proto/types/sha256.hpp"
#include "robots/geometry/mesh.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::cli {
namespace {

/// A version 8 UUID (RFC 9562, section 5.8) of what makes a report.
Uuid content_uuid(const Attempt& attempt, std::string_view content) {
  Sha256 hash;
  hash.add(std::string_view("kinship paths import 1"));
  hash.add(attempt.robot).add(std::string_view(attempt.task));
  hash.add(attempt.T_task_base->matrix()).add(content);
  const Digest digest = hash.finish();
  Uuid uuid;
  std::copy_n(digest.bytes.begin(), uuid.bytes.size(), uuid.bytes.begin());
  uuid.bytes[6] = static_cast<std::uint8_t>((uuid.bytes[6] & 0x0fU) | 0x80U);
  uuid.bytes[8] = static_cast<std::uint8_t>((uuid.bytes[8] & 0x3fU) | 0x80U);
  return uuid;
}

Result<kinematics::RobotModel> registered_robot(link::Client& server, const std::string& name) {
  const auto rows = link::rows_of(server, {.verb = AdminVerb::ShowRobot, .argument = name});
  if (!rows)
    return rows.error();
  if (rows->empty())
    return Error{ErrorCode::Internal, "the server answered without a row"};
  return kinematics::read_model(json::robot_description_from_json(rows->back()).value_or_throw());
}

/// The import of one source for one robot.
class ForeignImport {
 public:
  ForeignImport(link::Client& server, const ImportOptions& options,
                const kinematics::RobotModel& robot, std::ostream& err)
      : options_(options),
        chain_(robot.chain),
        err_(err),
        delivery_(server, err, options.progress) {}

  /// \throws Failure if the file cannot be read.
  void take_warehouse(const std::optional<Eigen::Isometry3d>& T_task_base) {
    const auto others = moveit::read_warehouse(
        options_.moveit_warehouse, chain_, T_task_base,
        [&](const std::string& name, Result<moveit::StoredTrajectory> trajectory) {
          if (trajectory)
            take(name, *std::move(trajectory));
          else
            delivery_.refuse(name, trajectory.error().message);
          return !delivery_.end();
        });
    for (const auto& [what, count] : others)
      left_out_[what] += count;
  }

  /// \throws Failure if the file cannot be read.
  void take_planner_data(const Eigen::Isometry3d& T_task_base) {
    const ompl_planners::RoadmapPaths found =
        ompl_planners::read_planner_data(options_.ompl_planner_data, chain_);
    for (std::size_t i = 0; i < found.paths.size(); ++i) {
      Attempt attempt = begin(options_.task, T_task_base, "ompl");
      attempt.path = found.paths[i];
      finish("path " + std::to_string(i + 1),
             Sha256().add(found.paths[i].waypoints()).finish().hex(), std::move(attempt));
    }
    if (found.without_way > 0)
      left_out_["goal that no start is connected with"] += found.without_way;
    left_out_["vertex that is on no such path"] += found.other_vertices;
  }

  int end(std::ostream& out) {
    const int code = delivery_.finish("path", options_.json, out);
    for (const auto& [what, count] : left_out_)
      if (count > 0)
        err_ << "left out: " << count << " x " << on_one_line(what) << '\n';
    return code;
  }

 private:
  Attempt begin(const std::string& task, const Eigen::Isometry3d& T_task_base,
                const std::string& planner) const {
    Attempt attempt;
    attempt.robot = chain_.digest();
    attempt.task = task;
    attempt.T_task_base = T_task_base;
    attempt.record.outcome = Outcome::Solved;
    attempt.record.planner = planner.substr(0, kMaxPlannerBytes);
    return attempt;
  }

  void finish(const std::string& place, std::string_view content, Attempt attempt) {
    attempt.report_uuid = content_uuid(attempt, content);
    delivery_.hold(place, std::move(attempt));
  }

  void take(const std::string& name, moveit::StoredTrajectory trajectory) {
    Attempt attempt =
        begin(options_.task.empty() ? trajectory.group : options_.task, trajectory.T_task_base,
              "moveit" + (trajectory.planner.empty() ? "" : " " + trajectory.planner));
    attempt.record.planning_time_s = trajectory.planning_time_s;
    attempt.path = std::move(trajectory.path);
    if (trajectory.scene) {
      auto scene = record(*std::move(trajectory.scene));
      if (scene)
        attempt.scene = *std::move(scene);
      else
        trajectory.left_out.push_back("the scene: " + scene.error().message);
    }
    for (const std::string& what : trajectory.left_out)
      ++left_out_[what];
    finish(name, trajectory.bytes, std::move(attempt));
  }

  /// With the meshes that the scene has in itself.
  Result<RecordedScene> record(moveit::Conversion conversion) {
    std::map<std::string, std::shared_ptr<const Eigen::Matrix3Xd>> triangles;
    for (const moveit::MeshFile& mesh : conversion.meshes) {
      auto corners = geometry::read_mesh(mesh.obj, "obj");
      if (!corners)
        return Error{corners.error().code, mesh.name + ": " + corners.error().message};
      triangles[mesh.name] = std::make_shared<const Eigen::Matrix3Xd>(*std::move(corners));
    }
    for (SceneMesh& object : conversion.problem.scene.meshes)
      object.mesh.triangles = triangles[object.mesh.file];
    for (AttachedObject& object : conversion.problem.attached)
      if (object.mesh)
        object.mesh->triangles = triangles[object.mesh->file];
    return scenes_.record(chain_, conversion.problem);
  }

  const ImportOptions& options_;
  const kinematics::Chain& chain_;
  std::ostream& err_;
  AttemptDelivery delivery_;
  guided::SceneRecords scenes_;
  std::map<std::string, std::size_t> left_out_;  // by what it is
};

}  // namespace

int import_foreign_paths(link::Client& server, const ImportOptions& options, std::ostream& out,
                         std::ostream& err) {
  if (options.moveit_warehouse.empty() && options.ompl_planner_data.empty())
    return refuse(kImportPaths,
                  invalid_input("names no file, --moveit-warehouse or --ompl-planner-data"), err);
  const auto placement = placement_of(options.placement);
  if (!placement)
    return refuse(kImportPaths, placement.error(), err);
  const auto robot = registered_robot(server, options.robot);
  if (!robot)
    return refuse(kImportPaths, robot.error(), err);
  ForeignImport import(server, options, *robot, err);
  if (options.moveit_warehouse.empty())
    import.take_planner_data(placement->value_or(Eigen::Isometry3d::Identity()));
  else
    import.take_warehouse(*placement);
  return import.end(out);
}

}  // namespace kinship::cli
