#include "server/fitting/experience_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "proto/types/sha256.hpp"

namespace kinship::fitting {
namespace {

/// Part of a revision: raised when equal paths are chosen or sampled otherwise.
constexpr std::uint64_t kExperienceVersion = 1;
constexpr double kMetresPerRadian = 0.3;

/// The parts of a path's pose that distances are computed from.
struct EndPose {
  explicit EndPose(const Eigen::Isometry3d& T) : p(T.translation()), q(T.linear()) {}
  Eigen::Vector3d p;
  Eigen::Quaterniond q;
};

struct PathEnds {
  explicit PathEnds(const PosePath& path) : start(path.poses.front()), goal(path.poses.back()) {}
  EndPose start, goal;
};

double distance(const EndPose& a, const EndPose& b) {
  const double cosine_of_half = std::min(1.0, std::abs(a.q.dot(b.q)));
  return (a.p - b.p).norm() + kMetresPerRadian * 2 * std::acos(cosine_of_half);
}

double distance(const PathEnds& a, const PathEnds& b) {
  return distance(a.start, b.start) + distance(a.goal, b.goal);
}

std::uint64_t revision_of(const std::vector<SharedPosePath>& paths) {
  Sha256 digest;
  digest.add(kExperienceVersion).add(std::uint64_t{paths.size()});
  for (const SharedPosePath& path : paths)
    digest.add(std::span<const std::uint8_t>(path->path.bytes));
  const Digest all = digest.finish();
  std::uint64_t revision = 0;
  for (std::size_t i = 0; i < sizeof revision; ++i)
    revision = (revision << 8U) | all.bytes[i];
  return std::max<std::uint64_t>(revision, 1);
}

/// How many of the paths, in this order, the bytes allow.
std::size_t count_within(const std::vector<SharedPosePath>& paths, std::size_t bytes) {
  std::size_t used = 0, count = 0;
  while (count < std::min(paths.size(), kMaxExperiencePaths)) {
    used += experience_bytes(paths[count]->poses.size());
    if (used > bytes)
      break;
    ++count;
  }
  return count;
}

}  // namespace

double distance_of_ends(const PosePath& a, const PosePath& b) {
  return distance(PathEnds(a), PathEnds(b));
}

ExperienceChoice choose_experience(const std::vector<SharedPosePath>& paths, std::size_t bytes) {
  std::vector<PathEnds> ends;
  ends.reserve(paths.size());
  for (const SharedPosePath& path : paths)
    ends.emplace_back(*path);
  // Negative: chosen.
  std::vector<double> to_chosen(paths.size(), std::numeric_limits<double>::infinity());
  const std::size_t most =
      std::min({paths.size(), kMaxExperiencePaths, bytes / experience_bytes(kMinPosesOfPath)});
  ExperienceChoice choice{0, paths.size(), {}};
  std::size_t used = 0;
  while (choice.paths.size() < most) {
    // From behind, so that the newest of equals is found.
    const auto farthest = std::max_element(to_chosen.rbegin(), to_chosen.rend());
    const auto next = static_cast<std::size_t>(to_chosen.rend() - farthest) - 1;
    used += experience_bytes(paths[next]->poses.size());
    if (used > bytes)
      break;
    choice.paths.push_back(paths[next]);
    for (std::size_t i = 0; i < ends.size(); ++i)
      if (to_chosen[i] > 0)
        to_chosen[i] = std::min(to_chosen[i], distance(ends[i], ends[next]));
    to_chosen[next] = -1;
  }
  choice.revision = revision_of(choice.paths);
  return choice;
}

ExperienceChoice shortened(const ExperienceChoice& choice, std::size_t bytes) {
  const std::size_t count = count_within(choice.paths, bytes);
  if (count == choice.paths.size())
    return choice;
  ExperienceChoice shorter{0, choice.paths_known, choice.paths};
  shorter.paths.resize(count);
  shorter.revision = revision_of(shorter.paths);
  return shorter;
}

TaskExperience to_experience(const ExperienceChoice& choice) {
  TaskExperience experience{choice.revision, choice.paths_known, {}};
  experience.paths.reserve(choice.paths.size());
  for (const SharedPosePath& path : choice.paths)
    experience.paths.push_back(*path);
  return experience;
}

}  // namespace kinship::fitting
