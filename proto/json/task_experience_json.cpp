#include "proto/json/task_experience_json.hpp"

#include <array>
#include <cinttypes>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "proto/json/writer.hpp"

namespace kinship::json {

std::string to_json(const TaskExperience& experience) {
  constexpr std::size_t kDigits = 16;
  std::array<char, kDigits + 1> revision{};
  std::snprintf(revision.data(), revision.size(), "%016" PRIx64, experience.revision);
  OrderedJson paths = OrderedJson::array();
  for (const PosePath& path : experience.paths) {
    OrderedJson poses = OrderedJson::array();
    for (const Eigen::Isometry3d& T_task_transfer : path.poses)
      poses.push_back(pose_list(T_task_transfer));
    paths.push_back(
        {{"path", path.path.text()}, {"source", path.source.hex()}, {"poses", std::move(poses)}});
  }
  return write(kTaskExperienceFormat, {{"revision", revision.data()},
                                       {"paths_known", experience.paths_known},
                                       {"paths", std::move(paths)}});
}

}  // namespace kinship::json
