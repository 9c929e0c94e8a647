#include "client/cli/scene_text.hpp"

#include <cmath>
#include <ostream>
#include <sstream>

namespace kinship::cli {
namespace {

/// A few digits, without zeros at the end.
std::string bound_text(double value) {
  constexpr int kDigits = 4;
  std::ostringstream text;
  text.precision(kDigits);
  text << value;
  return text.str();
}

}  // namespace

std::string region_text(const TaskSpaceRegion& region) {
  constexpr Eigen::Index kFirstAngle = 3;
  std::string bounds;
  for (Eigen::Index i = 0; i < region.bounds.cols(); ++i) {
    const double lower = region.bounds(0, i), upper = region.bounds(1, i);
    if (!std::isfinite(lower) && !std::isfinite(upper))
      continue;
    bounds += (bounds.empty() ? ": " : ", ") + std::string(displacement_name(i)) + " " +
              bound_text(lower) + ".." + bound_text(upper) + (i < kFirstAngle ? " m" : " rad");
  }
  return "stays within a task space region" + (bounds.empty() ? " without bounds" : bounds);
}

void print_scene(const RecordedScene& scene, std::ostream& out) {
  out << "scene       " << scene.objects.size() << " objects, " << scene.held.size() << " held\n";
  if (scene.constraint)
    out << "constraint  " << region_text(*scene.constraint) << '\n';
}

}  // namespace kinship::cli
