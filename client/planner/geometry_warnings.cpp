#include "client/planner/geometry_warnings.hpp"

#include <ostream>

#include "robots/geometry/geometry_doubts.hpp"

namespace kinship::planner {
namespace {

constexpr std::size_t kMaxTold = 20;  // of a run of many scenes

}  // namespace

void GeometryWarnings::tell_of(const Problem& problem) {
  const auto T_task_base = problem.T_task_base.value_or(Eigen::Isometry3d::Identity());
  for (const std::string& sentence : geometry::find_unreachable(
           robot_.chain, robot_.shapes, T_task_base, problem.scene, problem.attached))
    tell(problem, sentence);
}

void GeometryWarnings::tell_of(const Problem& problem,
                               const std::vector<collision::CollisionWorld::Enclosed>& enclosed) {
  for (const auto& [inner, mesh] : enclosed)
    tell(problem, "'" + inner + "' lies wholly within the mesh of '" + mesh +
                      "' at the start, and no check notices that: only the surface of a mesh is "
                      "touched; look at the mesh's scale, the poses and the placement");
}

void GeometryWarnings::tell(const Problem& problem, const std::string& sentence) {
  if (told_.size() == kMaxTold || !told_.insert(sentence).second)
    return;
  messages_ << "warning: problem '" << problem.name << "': " << sentence << '\n';
  if (told_.size() == kMaxTold)
    messages_ << "warning: more of this kind is not said\n";
}

}  // namespace kinship::planner
