#include "client/cli/path_export.hpp"

#include <functional>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <system_error>
#include <utility>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "client/moveit/trajectory_text.hpp"
#include "pages/mcap/path_recording.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/robot_description_json.hpp"
#include "robots/kinematics/timed_path.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kExportPaths = "paths export";

/// Takes a line of an experience file; returns false to end the export.
using UseLine = std::function<bool(const std::string& line)>;

std::string seconds_text(std::chrono::nanoseconds time) {
  return number_text(std::chrono::duration<double>(time).count(), 1) + " s";
}

/// Adds the newest paths in use.
std::optional<Error> list_newest(link::Client& server, const ExportOptions& options,
                                 std::vector<std::string>& ids) {
  const AdminRequest request{
      .verb = AdminVerb::ListPaths, .robot = options.robot, .task = options.task};
  return link::for_each_row(server, request, [&](const std::string& row) {
    const auto path = json::row_from_json<PathSummary>(row).value_or_throw();
    if (path.retired_ms == 0)
      ids.push_back(path.report_uuid.text());
    return ids.size() < options.limit;
  });
}

/// The lines of some paths, each robot before its first path.
std::optional<Error> for_each_line_of(link::Client& server, const std::vector<std::string>& ids,
                                      const UseLine& use) {
  std::set<Digest> described;
  for (const std::string& id : ids) {
    const auto row = link::first_row_of(server, {.verb = AdminVerb::ShowPath, .argument = id});
    if (!row)
      return row.error();
    const Attempt attempt = json::stored_attempt_from_json(*row).value_or_throw().attempt;
    if (!attempt.path)
      return Error{ErrorCode::NotFound, "path " + id + ": its waypoints are not kept"};
    if (described.insert(attempt.robot).second) {
      const auto robot =
          link::rows_of(server, {.verb = AdminVerb::ShowRobot, .argument = attempt.robot.hex()});
      if (!robot || robot->empty())
        return robot ? Error{ErrorCode::Internal, "the server answered without a row"}
                     : robot.error();
      if (!use(json::to_experience_line(
              json::robot_description_from_json(robot->back()).value_or_throw())))
        break;
    }
    if (!use(*row))
      break;
  }
  return std::nullopt;
}

std::optional<Error> for_each_line(link::Client& server, const ExportOptions& options,
                                   const UseLine& use) {
  if (options.ids.empty() && options.limit == 0)
    return link::for_each_row(
        server, {.verb = AdminVerb::ExportPaths, .robot = options.robot, .task = options.task},
        use);
  std::vector<std::string> ids = options.ids;
  if (ids.empty())
    if (const auto error = list_newest(server, options, ids))
      return error;
  return for_each_line_of(server, ids, use);
}

/// The same with the number of lines as progress. \return an exit code.
int use_lines(link::Client& server, const ExportOptions& options, std::ostream& err,
              const UseLine& use) {
  constexpr std::size_t kLinesAtOnce = 100;
  StatusLine progress(err, options.progress);
  std::size_t lines = 0;
  const auto error = for_each_line(server, options, [&](const std::string& line) {
    if (++lines % kLinesAtOnce == 0)
      progress.show(std::string(kExportPaths) + ": " + count_text(lines, "line"));
    return use(line);
  });
  progress.clear();
  return error ? refuse(kExportPaths, *error, err) : kDone;
}

int write_lines(link::Client& server, const ExportOptions& options, std::ostream& out,
                std::ostream& err) {
  files::OutputFile output(options.output, out);
  std::size_t lines = 0;
  const int code = use_lines(server, options, err, [&](const std::string& line) {
    output.stream() << line << '\n';
    ++lines;
    return output.stream().good();
  });
  if (code != kDone)
    return code;
  output.keep();
  if (!options.output.empty())
    err << count_text(lines, "line") << " in '" << options.output.string() << "'\n";
  return kDone;
}

/// What was chosen, for the recording's metadata.
std::map<std::string, std::string> choice_of(const ExportOptions& options) {
  std::map<std::string, std::string> choice;
  if (!options.robot.empty())
    choice["robot"] = options.robot;
  if (!options.task.empty())
    choice["task"] = options.task;
  if (options.limit > 0)
    choice["limit"] = std::to_string(options.limit);
  return choice;
}

/// Hands over the robots and the attempts that have a path; the others are counted.
int use_paths(link::Client& server, const ExportOptions& options, std::ostream& err,
              const std::function<void(RobotDescription)>& use_robot,
              const std::function<bool(const Attempt&)>& use_path, std::size_t& without_path) {
  return use_lines(server, options, err, [&](const std::string& line) {
    json::ExperienceLine parsed = json::experience_line_from_json(line).value_or_throw();
    if (auto* robot = std::get_if<RobotDescription>(&parsed))
      use_robot(std::move(*robot));
    else if (const Attempt& attempt = std::get<json::NamedAttempt>(parsed).attempt; attempt.path)
      return use_path(attempt);
    else
      ++without_path;
    return true;
  });
}

std::string left_out_text(std::size_t without_path) {
  return without_path == 0
             ? ""
             : "; " + count_text(without_path, "attempt") + " without a path left out";
}

int write_recording(link::Client& server, const ExportOptions& options, std::ostream& out,
                    std::ostream& err) {
  const std::filesystem::path file = options.mcap == "-" ? std::filesystem::path() : options.mcap;
  files::OutputFile output(file, out);
  mcap::PathRecording recording(output.stream(), choice_of(options));
  std::size_t without_path = 0;
  const auto use_robot = [&](RobotDescription robot) { recording.add_robot(std::move(robot)); };
  const auto use_path = [&](const Attempt& attempt) {
    recording.add_path(attempt);
    return output.stream().good();
  };
  const int code = use_paths(server, options, err, use_robot, use_path, without_path);
  if (code != kDone)
    return code;
  if (recording.paths() == 0)
    return refuse(kExportPaths, {ErrorCode::NotFound, "nothing to record: no path"}, err);
  recording.finish();
  output.keep();
  err << count_text(recording.paths(), "path") << ", " << seconds_text(recording.duration())
      << (file.empty() ? "" : ", in '" + file.string() + "'") << left_out_text(without_path)
      << '\n';
  return kDone;
}

/// Writes paths as messages of MoveIt.
class TrajectoryFiles {
 public:
  TrajectoryFiles(const std::filesystem::path& place, std::ostream& out) : out_(out) {
    std::error_code unreadable;
    is_folder_ = !place.has_filename() || std::filesystem::is_directory(place, unreadable);
    if (is_folder_)
      folder_ = place;
    else
      output_.emplace(place == "-" ? std::filesystem::path() : place, out);
  }

  std::size_t paths() const noexcept { return paths_; }

  void add_robot(RobotDescription description) {
    kinematics::RobotModel robot = kinematics::read_model(std::move(description)).value_or_throw();
    const Digest digest = robot.chain.digest();
    robots_.insert_or_assign(digest, std::move(robot));
  }

  bool add_path(const Attempt& attempt) {
    const kinematics::RobotModel& robot = robots_.at(attempt.robot);
    const kinematics::TimedPath path =
        kinematics::timed(*attempt.path, kinematics::path_speeds(robot), 0);
    const std::string id = attempt.report_uuid.text();
    const std::string note = "Path " + id + " of robot '" + robot.description.label + "', task '" +
                             attempt.task + "'. " + kTimes;
    const std::string shown = moveit::display_trajectory_text(robot, path, note);
    if (is_folder_) {
      std::filesystem::create_directories(folder_);
      write(folder_ / (id + ".display.yaml"), shown);
      write(folder_ / (id + ".trajectory.yaml"), moveit::robot_trajectory_text(robot, path, note));
    } else {
      output_->stream() << (paths_ == 0 ? "" : "---\n") << shown;
    }
    ++paths_;
    return is_folder_ || output_->stream().good();
  }

  void keep() {
    if (output_)
      output_->keep();
  }

  static constexpr const char* kTimes =
      "Times: the shortest under the velocity limits of the URDF (1 rad/s or 0.25 m/s where there "
      "is none); a URDF has no limits of acceleration.";

 private:
  void write(const std::filesystem::path& file, const std::string& text) const {
    files::OutputFile output(file, out_);
    output.stream() << text;
    output.keep();
  }

  std::ostream& out_;
  bool is_folder_ = false;
  std::filesystem::path folder_;
  std::optional<files::OutputFile> output_;
  std::map<Digest, kinematics::RobotModel> robots_;
  std::size_t paths_ = 0;
};

int write_trajectories(link::Client& server, const ExportOptions& options, std::ostream& out,
                       std::ostream& err) {
  TrajectoryFiles files(options.moveit, out);
  std::size_t without_path = 0;
  const int code = use_paths(
      server, options, err, [&](RobotDescription robot) { files.add_robot(std::move(robot)); },
      [&](const Attempt& attempt) { return files.add_path(attempt); }, without_path);
  if (code != kDone)
    return code;
  if (files.paths() == 0)
    return refuse(kExportPaths, {ErrorCode::NotFound, "nothing to write: no path"}, err);
  files.keep();
  err << count_text(files.paths(), "path")
      << (options.moveit == "-" ? "" : " in '" + options.moveit.string() + "'")
      << left_out_text(without_path) << '\n'
      << TrajectoryFiles::kTimes << '\n';
  return kDone;
}

}  // namespace

int export_paths(link::Client& server, const ExportOptions& options, std::ostream& out,
                 std::ostream& err) {
  ExportOptions here = options;
  here.progress = options.progress && !(options.output.empty() && options.mcap.empty() &&
                                        options.moveit.empty() && is_terminal(out));
  if (!options.moveit.empty())
    return write_trajectories(server, here, out, err);
  return options.mcap.empty() ? write_lines(server, here, out, err)
                              : write_recording(server, here, out, err);
}

}  // namespace kinship::cli
