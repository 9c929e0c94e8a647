#include "client/guided/geometry_warnings.hpp"

#include "robots/geometry/geometry_doubts.hpp"

namespace kinship::guided {
namespace {

constexpr std::size_t kMaxTold = 20;  // of a run of many scenes

}  // namespace

std::vector<std::string> GeometryWarnings::find(const Problem& problem,
                                                const PlannedProblem& planned) {
  const auto T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  std::vector<std::string> doubts =
      geometry::find_scene_doubts(chain_, shapes_, T_task_base, problem.scene, problem.attached);
  for (const auto& [inner, mesh] : planned.enclosed)
    doubts.push_back("'" + inner + "' lies wholly within the mesh of '" + mesh +
                     "' at the start, and no check notices that: only the surface of a mesh is "
                     "touched; look at the mesh's scale, the poses and the placement");
  std::vector<std::string> sentences;
  for (const std::string& doubt : doubts) {
    if (told_.size() == kMaxTold || !told_.insert(doubt).second)
      continue;
    sentences.push_back("problem '" + problem.name + "': " + doubt);
    if (told_.size() == kMaxTold)
      sentences.emplace_back("more of this kind is not said");
  }
  return sentences;
}

}  // namespace kinship::guided
