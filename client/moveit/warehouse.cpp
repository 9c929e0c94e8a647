#include "client/moveit/warehouse.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "client/moveit/cdr_message.hpp"
#include "client/moveit/frames.hpp"
#include "client/moveit/goals.hpp"
#include "client/moveit/objects.hpp"
#include "client/moveit/yaml_value.hpp"
#include "proto/types/number_text.hpp"

namespace kinship::moveit {
namespace {

constexpr int kSchemaVersion = 10;
constexpr int kMaxMessageBytes = 16'000'000;
constexpr const char* kSceneDatabase = "moveit_planning_scenes";
constexpr std::string_view kMessages = "moveit_msgs::msg::";
constexpr double kStill = 1e-6;  // m or rad: a joint that moves less stands

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char letter : name)
    text += letter == '"' ? "\"\"" : std::string(1, letter);
  return text + "\"";
}

/// A warehouse's file, open for reading.
class Database {
 public:
  explicit Database(const std::filesystem::path& file) : name_(file.string()) {
    std::error_code unreadable;
    if (!std::filesystem::is_regular_file(file, unreadable))
      throw Failure(ErrorCode::NotFound, "'" + name_ + "': no such file");
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(name_.c_str(), &handle, SQLITE_OPEN_READONLY, nullptr);
    handle_.reset(handle);
    if (code != SQLITE_OK)
      fail();
    sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kMaxMessageBytes);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);  // a stranger's views
  }

  [[noreturn]] void fail() const {
    throw Failure(ErrorCode::InvalidInput, "'" + name_ + "': " + sqlite3_errmsg(handle_.get()));
  }
  sqlite3* get() const noexcept { return handle_.get(); }
  const std::string& name() const noexcept { return name_; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const noexcept { sqlite3_close_v2(handle); }
  };
  std::string name_;
  std::unique_ptr<sqlite3, Close> handle_;
};

/// A statement and its rows.
class Rows {
 public:
  Rows(const Database& database, const std::string& sql,
       const std::vector<std::string>& parameters = {})
      : database_(database) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database.get(), sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
      database.fail();
    statement_.reset(statement);
    for (std::size_t i = 0; i < parameters.size(); ++i)  // the warehouse keeps texts as blobs
      if (sqlite3_bind_blob64(statement, static_cast<int>(i) + 1, parameters[i].data(),
                              parameters[i].size(), SQLITE_TRANSIENT) != SQLITE_OK)
        database.fail();
  }

  bool next() {
    const int code = sqlite3_step(statement_.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE)
      database_.fail();
    return code == SQLITE_ROW;
  }

  std::string bytes(int column) const {
    const void* data = sqlite3_column_blob(statement_.get(), column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
    return data == nullptr ? std::string() : std::string(static_cast<const char*>(data), size);
  }
  double number(int column) const { return sqlite3_column_double(statement_.get(), column); }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const noexcept { sqlite3_finalize(statement); }
  };
  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
};

struct Collection {
  std::string table, database, name, type;

  std::string text() const { return database + "/" + name; }
};

/// Reads the trajectories of one file for one robot.
class Warehouse {
 public:
  Warehouse(const std::filesystem::path& file, const kinematics::Chain& chain,
            const std::optional<Eigen::Isometry3d>& T_task_base)
      : database_(file), chain_(chain), T_task_base_(T_task_base) {
    Rows version(database_, "PRAGMA user_version");
    version.next();
    if (const int found = static_cast<int>(version.number(0)); found != kSchemaVersion)
      throw Failure(ErrorCode::InvalidInput,
                    "'" + database_.name() + "': no warehouse of warehouse_ros_sqlite: schema " +
                        std::to_string(found) + " instead of " + std::to_string(kSchemaVersion));
    Rows rows(database_,
              "SELECT MangledTableName, WarehouseDatabaseName, WarehouseCollectionName, "
              "MessageDataType FROM WarehouseIndex ORDER BY MangledTableName");
    while (rows.next())
      collections_.push_back({rows.bytes(0), rows.bytes(1), rows.bytes(2), rows.bytes(3)});
  }

  std::map<std::string, std::size_t> read(const UseTrajectory& use) {
    std::map<std::string, std::size_t> others;
    for (const Collection& collection : collections_) {
      if (collection.type == std::string(kMessages) + "RobotTrajectory") {
        if (!read_collection(collection, use))
          break;
      } else if (!is_beside_trajectories(collection)) {
        Rows count(database_, "SELECT count(*) FROM " + quoted(collection.table));
        count.next();
        if (const auto messages = static_cast<std::size_t>(count.number(0)); messages > 0)
          others[collection.text() + " of " + collection.type] = messages;
      }
    }
    return others;
  }

 private:
  /// Scenes and requests, which are read with their trajectories.
  static bool is_beside_trajectories(const Collection& collection) {
    return collection.database == kSceneDatabase &&
           (collection.type == std::string(kMessages) + "PlanningScene" ||
            collection.type == std::string(kMessages) + "MotionPlanRequest");
  }

  /// A column of a collection's table, or what stands for one that it does not have.
  std::string column(const Collection& collection, const std::string& name) const {
    return sqlite3_table_column_metadata(database_.get(), nullptr, collection.table.c_str(),
                                         name.c_str(), nullptr, nullptr, nullptr, nullptr,
                                         nullptr) == SQLITE_OK
               ? quoted(name)
               : "NULL";
  }

  bool read_collection(const Collection& collection, const UseTrajectory& use) {
    Rows rows(database_, "SELECT M_id, Data, " + column(collection, "M_planning_scene_id") + ", " +
                             column(collection, "M_motion_request_id") + ", " +
                             column(collection, "M_planning_time_s") + " FROM " +
                             quoted(collection.table) + " ORDER BY M_id");
    while (rows.next()) {
      const std::string name = collection.text() + " " + rows.bytes(0);
      if (!use(name, read_row(collection, rows, name)))
        return false;
    }
    return true;
  }

  Result<StoredTrajectory> read_row(const Collection& collection, const Rows& row,
                                    const std::string& name) {
    try {
      const std::string bytes = row.bytes(1);
      std::vector<std::string> left_out;
      StoredTrajectory trajectory{
          .name = name,
          .group = collection.name,
          .planner = {},
          .planning_time_s = std::max(0.0, row.number(4)),
          .bytes = bytes,
          .path = read_path(document(bytes, "RobotTrajectory", name), left_out)};
      trajectory.left_out = std::move(left_out);
      trajectory.T_task_base = T_task_base_.value_or(planning_frame());
      if (collection.database == kSceneDatabase) {
        trajectory.group = row.bytes(2);
        add_scene(row.bytes(2), row.bytes(3), trajectory);
      }
      return trajectory;
    } catch (const Failure& failure) {
      return failure.error();
    }
  }

  YamlValue document(const std::string& bytes, const char* message, const std::string& name) const {
    try {
      return YamlValue::of_document(read_cdr(bytes, message), name);
    } catch (const Failure& failure) {
      throw Failure(failure.code(), "'" + name + "' is no " + message + ": " + failure.what());
    }
  }

  /// Where the base stands if MoveIt's planning frame is the task frame.
  Eigen::Isometry3d planning_frame() const {
    const YamlValue none = YamlValue::of_document(YAML::Node(YAML::NodeType::Map), {});
    return Frames(chain_, std::nullopt, middle(), none, none).T_task_base();
  }
  Eigen::VectorXd middle() const { return (chain_.lower() + chain_.upper()) / 2; }

  /// Trajectories that follow each other mostly share their scene: the last one is kept.
  const std::optional<YamlValue>& scene_named(const std::string& name) {
    if (!last_scene_name_ || *last_scene_name_ != name) {
      last_scene_name_.reset();
      last_scene_.reset();  // a node that is assigned to would keep both documents
      last_scene_ = newest("planning_scene", "PlanningScene", name, "");
      last_scene_name_ = name;
    }
    return last_scene_;
  }

  Path read_path(const YamlValue& trajectory, std::vector<std::string>& left_out) const;
  std::optional<YamlValue> newest(const char* collection, const char* type,
                                  const std::string& scene, const std::string& request) const;
  void add_scene(const std::string& scene_name, const std::string& request_name,
                 StoredTrajectory& trajectory);

  Database database_;
  const kinematics::Chain& chain_;
  std::optional<Eigen::Isometry3d> T_task_base_;
  std::vector<Collection> collections_;
  std::optional<std::string> last_scene_name_ = {};
  std::optional<YamlValue> last_scene_ = {};
};

/// moveit_msgs/RobotTrajectory
Path Warehouse::read_path(const YamlValue& trajectory, std::vector<std::string>& left_out) const {
  if (const YamlValue points = trajectory["multi_dof_joint_trajectory"]["points"];
      !points.items().empty())
    points.refuse("a base that moves");
  const YamlValue joints = trajectory["joint_trajectory"];
  const std::vector<YamlValue> names = joints["joint_names"].items();
  const std::vector<YamlValue> points = joints["points"].items();
  Eigen::MatrixXd all(static_cast<Eigen::Index>(names.size()),
                      static_cast<Eigen::Index>(points.size()));
  for (std::size_t point = 0; point < points.size(); ++point) {
    const std::vector<YamlValue> positions = points[point]["positions"].items();
    if (positions.size() != names.size())
      points[point]["positions"].refuse(std::to_string(positions.size()) + " positions of " +
                                        std::to_string(names.size()) + " joints");
    for (std::size_t joint = 0; joint < names.size(); ++joint)
      all(static_cast<Eigen::Index>(joint), static_cast<Eigen::Index>(point)) =
          positions[joint].number();
  }
  Eigen::MatrixXd chosen(chain_.dof(), all.cols());
  std::vector<bool> is_used(names.size(), false);
  for (Eigen::Index joint = 0; joint < chain_.dof(); ++joint) {
    const std::string& wanted = chain_.joints()[static_cast<std::size_t>(joint)].name;
    const auto found =
        std::ranges::find_if(names, [&](const YamlValue& name) { return name.text() == wanted; });
    if (found == names.end())
      joints["joint_names"].refuse("joint '" + wanted + "' of the robot is not among them");
    const auto index = static_cast<std::size_t>(found - names.begin());
    is_used[index] = true;
    chosen.row(joint) = all.row(static_cast<Eigen::Index>(index));
  }
  for (std::size_t joint = 0; joint < names.size(); ++joint) {
    const auto row = all.row(static_cast<Eigen::Index>(joint));
    if (!is_used[joint] && row.size() > 0 && row.maxCoeff() - row.minCoeff() > kStill)
      left_out.push_back("the motion of joint '" + names[joint].text() + "', not of the chain");
  }
  Eigen::Index kept = 0;  // a waypoint that repeats the one before says nothing
  for (Eigen::Index point = 0; point < chosen.cols(); ++point)
    if (kept == 0 || chosen.col(point) != chosen.col(kept - 1))
      chosen.col(kept++) = chosen.col(point);
  if (kept < 2)
    joints["points"].refuse("no motion of the robot's joints");
  return Path(chosen.leftCols(kept));
}

/// The newest message of MoveIt's planning scene storage with these names.
std::optional<YamlValue> Warehouse::newest(const char* collection, const char* type,
                                           const std::string& scene,
                                           const std::string& request) const {
  const auto found = std::ranges::find_if(collections_, [&](const Collection& each) {
    return each.database == kSceneDatabase && each.name == collection &&
           each.type == std::string(kMessages) + type;
  });
  if (found == collections_.end())
    return std::nullopt;
  std::string sql = "SELECT M_id, Data FROM " + quoted(found->table) + " WHERE CAST(" +
                    column(*found, "M_planning_scene_id") + " AS BLOB) = ?";
  std::vector<std::string> parameters = {scene};
  if (!request.empty()) {
    sql += " AND CAST(" + column(*found, "M_motion_request_id") + " AS BLOB) = ?";
    parameters.push_back(request);
  }
  Rows rows(database_, sql + " ORDER BY M_id DESC LIMIT 1", parameters);
  if (!rows.next())
    return std::nullopt;
  return document(rows.bytes(1), type, found->text() + " " + rows.bytes(0));
}

void Warehouse::add_scene(const std::string& scene_name, const std::string& request_name,
                          StoredTrajectory& trajectory) {
  const YamlValue none = YamlValue::of_document(YAML::Node(YAML::NodeType::Map), {});
  const auto leave_out = [&](const std::string& what, const std::string& why) {
    trajectory.left_out.push_back(what + ": " + why);
  };
  YamlValue request = none;
  try {
    if (const auto found =
            newest("motion_plan_request", "MotionPlanRequest", scene_name, request_name))
      request = *found;
    else
      leave_out("the request", "it is not in the warehouse");
    trajectory.planner = request["planner_id"].text_or("");
  } catch (const Failure& failure) {
    leave_out("the request", failure.what());
  }
  try {
    const std::optional<YamlValue>& scene = scene_named(scene_name);
    if (!scene) {
      leave_out("the scene", "it is not in the warehouse");
      return;
    }
    if (const YamlValue difference = (*scene)["is_diff"]; difference.flag())
      difference.refuse("a change to another scene, which says not all that is there");
    const Frames frames(chain_, T_task_base_, trajectory.path.waypoints().col(0), *scene, request);
    trajectory.T_task_base = frames.T_task_base();
    Conversion conversion;
    read_objects(*scene, request, chain_, frames, conversion);
    conversion.problem.constraint = read_constraint(request, frames, conversion.left_out);
    trajectory.left_out.insert(trajectory.left_out.end(), conversion.left_out.begin(),
                               conversion.left_out.end());
    trajectory.scene = std::move(conversion);
  } catch (const Failure& failure) {
    leave_out("the scene", failure.what());
  }
}

}  // namespace

std::map<std::string, std::size_t> read_warehouse(
    const std::filesystem::path& file, const kinematics::Chain& chain,
    const std::optional<Eigen::Isometry3d>& T_task_base, const UseTrajectory& use) {
  return Warehouse(file, chain, T_task_base).read(use);
}

}  // namespace kinship::moveit
