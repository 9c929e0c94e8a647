#include "robots/recall/clear_path.hpp"

#include <algorithm>
#include <variant>

#include "proto/types/recall_library.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/shortcut.hpp"

namespace kinship::recall {
namespace {

struct Enlarge {
  double by_m;

  void operator()(BoxShape& box) const { box.size.array() += 2 * by_m; }
  void operator()(CylinderShape& cylinder) const {
    cylinder.radius_m += by_m;
    cylinder.length_m += 2 * by_m;
  }
  void operator()(SphereShape& sphere) const { sphere.radius_m += by_m; }
  void operator()(CapsuleShape& capsule) const { capsule.radius_m += by_m; }
};

constexpr double kLongestBeginning = 0.2;  // part of a path

}  // namespace

collision::Surroundings enlarged(collision::Surroundings surroundings, double by_m) {
  for (SceneObject& object : surroundings.scene.objects)
    std::visit(Enlarge{by_m}, object.shape);
  return surroundings;
}

std::optional<Eigen::MatrixXd> clear_path(const Eigen::MatrixXd& path,
                                          const planning::IsFree& is_clear,
                                          const Eigen::Matrix2Xd& bounds,
                                          const ClearPathOptions& options,
                                          std::mt19937_64& generator) {
  const Eigen::MatrixXd dense =
      options.constraint != nullptr ? path : planning::densified(path, options.step);
  Eigen::Index first = 0, last = dense.cols() - 1;
  while (first < dense.cols() && !is_clear(dense.col(first)))
    ++first;
  while (last > first && !is_clear(dense.col(last)))
    --last;
  if (first >= last ||
      static_cast<double>(first) > kLongestBeginning * static_cast<double>(dense.cols()))
    return std::nullopt;
  planning::BirrtOptions plan;
  plan.step = options.step;
  plan.max_checks = options.plan_checks;
  plan.time_limit = kNoTimeLimit;
  const planning::ConfigurationSampler sampler(bounds);
  const planning::ShortcutOptions polish{options.step, options.polish_checks};
  const planning::PlanSummary found = planning::plan_trees(
      dense.col(first), dense.col(last), {is_clear, options.constraint}, sampler, plan, generator);
  if (!found.waypoints)
    return std::nullopt;
  const Eigen::MatrixXd middle =
      planning::shortcut(*found.waypoints, is_clear, options.constraint, polish, generator)
          .waypoints;
  const Eigen::Index behind = dense.cols() - 1 - last;
  Eigen::MatrixXd clear(dense.rows(), first + middle.cols() + behind);
  clear << dense.leftCols(first), middle, dense.rightCols(behind);
  return clear;
}

Eigen::MatrixXd equal_parts(const Eigen::MatrixXd& path) {
  const double length = planning::path_length(path);
  Eigen::MatrixXd parts(path.rows(), kRecallWaypoints);
  Eigen::Index next = 1;
  double before = 0;  // up to the waypoint before `next`
  for (int i = 0; i < kRecallWaypoints; ++i) {
    const double wanted = length * i / (kRecallWaypoints - 1);
    double line = (path.col(next) - path.col(next - 1)).norm();
    while (next < path.cols() - 1 && before + line < wanted) {
      before += line;
      ++next;
      line = (path.col(next) - path.col(next - 1)).norm();
    }
    const double share = line > 0 ? std::clamp((wanted - before) / line, 0.0, 1.0) : 0;
    parts.col(i) = path.col(next - 1) + share * (path.col(next) - path.col(next - 1));
  }
  parts.col(0) = path.col(0);
  parts.rightCols<1>() = path.rightCols<1>();
  return parts;
}

}  // namespace kinship::recall
