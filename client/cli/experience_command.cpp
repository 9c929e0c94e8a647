#include "client/cli/experience_command.hpp"

#include <map>
#include <ostream>

#include "client/cli/admin_rows.hpp"
#include "client/cli/cell_text.hpp"
#include "client/link/robot_names.hpp"
#include "proto/json/task_experience_json.hpp"
#include "proto/tables/table.hpp"

namespace kinship::cli {
namespace {

using tables::Fit;
using tables::Table;

constexpr const char* kExperienceCommand = "tasks experience";

std::string position_text(const Eigen::Isometry3d& T_task_transfer) {
  constexpr int kDigits = 2;
  std::string text;
  for (const double number : T_task_transfer.translation())
    text += (text.empty() ? "" : " ") + number_text(number, kDigits);
  return text;
}

/// The labels of the robots that the paths are from; digests of robots without one.
std::map<Digest, std::string> labels_of(link::Client& server, const TaskExperience& experience) {
  std::map<Digest, std::string> labels;
  for (const PosePath& path : experience.paths)
    if (!labels.contains(path.source)) {
      const auto robot = link::find_robot(server, path.source.hex());
      labels.emplace(path.source, robot ? robot->label : path.source.short_hex());
    }
  return labels;
}

}  // namespace

int show_experience(link::Client& server, const ExperienceOptions& options, std::ostream& out,
                    std::ostream& err) {
  FetchRequest request;
  request.task = options.task;  // and no robot: it is for any
  request.experience_bytes = options.max_bytes;
  const Result<FetchReply> reply = server.fetch(request);
  if (!reply)
    return refuse(kExperienceCommand, reply.error(), err);
  if (reply->status == FetchStatus::Refused)
    return refuse(kExperienceCommand, {ErrorCode::InvalidInput, reply->message}, err);
  if (reply->status == FetchStatus::Busy)
    return refuse(kExperienceCommand, {ErrorCode::Unavailable, reply->message}, err);
  if (!reply->experience)
    return refuse(
        kExperienceCommand,
        {ErrorCode::NotFound, "no paths of task '" + options.task + "' (see: kinship tasks list)"},
        err);
  const TaskExperience& experience = *reply->experience;
  if (options.json) {
    out << json::to_json(experience) << '\n';
    return kDone;
  }
  const std::map<Digest, std::string> labels = labels_of(server, experience);
  Table table({{"SOURCE", Fit::Cut},
               "PATH",
               "START",
               "GOAL",
               {"START POSE", Fit::Wide},
               {"GOAL POSE", Fit::Wide}});
  for (const PosePath& path : experience.paths)
    table.add_row({labels.at(path.source), path.path.text(), position_text(path.poses.front()),
                   position_text(path.poses.back()), pose_text(path.poses.front()),
                   pose_text(path.poses.back())});
  table.print(out);
  out << experience.paths.size() << " of " << count_text(experience.paths_known, "path") << '\n';
  return kDone;
}

}  // namespace kinship::cli
