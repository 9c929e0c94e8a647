#include "proto/codec/experience_codec.hpp"

#include <algorithm>
#include <string>

#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/fields.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

constexpr std::size_t kNumbersOfPose = 7;

std::string name_of(const Uuid& path) { return "experience: path " + path.text(); }

void check_pose_count(const Uuid& path, std::size_t poses, Rules& rules) {
  if (poses < kMinPosesOfPath || poses > kMaxPosesOfPath)
    rules.between(name_of(path) + ": poses", static_cast<double>(poses), kMinPosesOfPath,
                  kMaxPosesOfPath);
}

void check_path(const PosePath& path, Rules& rules) {
  check_pose_count(path.path, path.poses.size(), rules);
  const auto is_bad = [](const Eigen::Isometry3d& T_task_transfer) {
    return !T_task_transfer.matrix().allFinite() ||
           T_task_transfer.translation().cwiseAbs().maxCoeff() > kMaxPlacement_m;
  };
  const auto bad = std::find_if(path.poses.begin(), path.poses.end(), is_bad);
  if (bad != path.poses.end())
    rules.pose(name_of(path.path), *bad);
}

}  // namespace

static void write_part(const PosePath& path, Arena& arena, kinship_wire_PosePath& wire) {
  write_digest(path.source, wire.source);
  write_uuid(path.path, wire.path);
  arena.resize(wire.poses, kNumbersOfPose * path.poses.size());
  float* next = wire.poses._buffer;
  for (const Eigen::Isometry3d& T_task_transfer : path.poses)
    for (const double number : to_pose_array(T_task_transfer))
      *next++ = static_cast<float>(number);
}

static void read_part(const kinship_wire_PosePath& wire, Reader& reader, PosePath& path) {
  path.source = read_digest(wire.source);
  path.path = read_uuid(wire.path);
  const auto numbers = elements(wire.poses);
  if (numbers.size() % kNumbersOfPose != 0)
    reader.rules.that(false, name_of(path.path) + ": " + std::to_string(numbers.size()) +
                                 " numbers are not a multiple of 7");
  check_pose_count(path.path, numbers.size() / kNumbersOfPose, reader.rules);
  if (reader.rules.broken())
    return;
  path.poses.reserve(numbers.size() / kNumbersOfPose);
  for (std::size_t i = 0; i < numbers.size(); i += kNumbersOfPose) {
    PoseArray pose{};
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i), pose.size(), pose.begin());
    path.poses.push_back(reader.pose("experience: pose", pose));
  }
}

std::optional<Error> validate(const TaskExperience& experience) {
  Rules rules;
  rules.that(experience.revision != 0, "experience: revision 0")
      .at_most("experience: paths", experience.paths.size(), kMaxExperiencePaths)
      .that(experience.paths.size() <= experience.paths_known,
            "experience: " + std::to_string(experience.paths.size()) + " paths of " +
                std::to_string(experience.paths_known) + " known");
  for (const PosePath& path : experience.paths) {
    if (rules.broken())
      break;
    check_path(path, rules);
  }
  return rules.broken();
}

void write_part(const TaskExperience& experience, Arena& arena, kinship_wire_TaskExperience& wire) {
  wire.revision = experience.revision;
  wire.paths_known = experience.paths_known;
  write_value(experience.paths, {}, arena, wire.paths);
}

void read_part(const kinship_wire_TaskExperience& wire, Reader& reader,
               TaskExperience& experience) {
  experience.revision = wire.revision;
  experience.paths_known = wire.paths_known;
  experience.paths = read_value<std::vector<PosePath>>({"experience: paths"}, wire.paths,
                                                       {.limit = kMaxExperiencePaths}, reader);
}

}  // namespace kinship::codec
