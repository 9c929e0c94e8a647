#include "server/fitting/fit_need.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "proto/types/limits.hpp"
#include "proto/types/stopped.hpp"

namespace kinship::fitting {
namespace {

constexpr std::uint64_t kPathsUnderWay = 32;  // that one thread may transfer at a time
constexpr double kBytesOfANumber = 8;

std::uint64_t max_poses(const TransferParameters& transfer) {
  return transfer.max_poses_per_path == 0 ? kMaxWaypoints
                                          : static_cast<std::uint64_t>(transfer.max_poses_per_path);
}

/// As `resample` counts them, and one more for rounding.
std::uint64_t poses_of(double length, const TransferParameters& transfer) {
  const double kept = length * (1 - 2 * transfer.dropped_end_share);
  const double poses = std::ceil(kept / transfer.pose_spacing) + 2;
  return static_cast<std::uint64_t>(
      std::clamp(poses, 1.0, static_cast<double>(max_poses(transfer))));
}

/// Further memory of threads while they transfer: each pose, each track that is tried or kept, and
/// the configurations among which tracks begin.
double bytes_under_way(const FitNeed& need, const FitSize& size) {
  constexpr double kBytesOfAPose = 1024;
  const TransferParameters& transfer = size.key.profile.transfer;
  const double numbers = static_cast<double>(need.dof) * kBytesOfANumber;
  const double tracks = transfer.tracks;
  const double per_pose =
      kBytesOfAPose + numbers * (2 * tracks + 2 * static_cast<double>(need.solutions) + 4);
  const double starts = std::min(static_cast<double>(need.longest), 6 * (tracks + 1));
  const double per_path =
      static_cast<double>(need.longest) * per_pose + starts * transfer.track_candidates * numbers;
  const std::uint64_t paths =
      std::min(need.paths, kPathsUnderWay * static_cast<std::uint64_t>(std::max(size.threads, 1)));
  return static_cast<double>(paths) * per_path;
}

/// The sums of EM, one set per part of the points, and the covariances.
double bytes_of_estimate(const FitSize& size) {
  constexpr double kParts = 40;
  const auto dof = static_cast<double>(size.dof);
  const DensityParameters& density = size.key.profile.density;
  const double components = density.components == 0 ? 128 : density.components;
  return density.estimator == Estimator::Kernels
             ? static_cast<double>(kMaxKernels) * dof * kBytesOfANumber * 8
             : components * (dof + 1) * (dof + 2) / 2 * kBytesOfANumber * kParts;
}

FitNeed need_of(const FitSize& size, std::uint64_t poses, std::uint64_t longest) {
  const TransferParameters& transfer = size.key.profile.transfer;
  FitNeed need;
  for (const std::uint64_t paths : size.wanted)
    need.paths += paths;
  need.poses = poses;
  need.longest = longest;
  need.solutions = static_cast<std::uint64_t>(std::max(transfer.max_solutions, transfer.tracks));
  need.dof = size.dof;
  const double configurations =
      static_cast<double>(need.poses) * static_cast<double>(need.solutions);
  const double bytes = configurations * static_cast<double>(bytes_of_configuration(size.dof)) +
                       bytes_under_way(need, size) + bytes_of_estimate(size);
  constexpr double kMost = 1e18;  // a sum of 64 bits holds it
  need.bytes = static_cast<std::size_t>(std::min(bytes, kMost));
  return need;
}

/// The poses of the paths of a source that are in use.
std::vector<std::uint64_t> poses_of_source(const FitSize& size, const Digest& robot,
                                           const store::ExperienceStore& store,
                                           const std::stop_token& stop) {
  std::vector<std::uint64_t> poses;
  std::string cursor;
  do {
    throw_if_stopped(stop);
    const store::Page<PathSummary> page =
        store.list_paths(robot, size.key.task, cursor, kMaxPageRows);
    for (const PathSummary& path : page.rows)
      if (path.retired_ms == 0 && path.received_ms >= size.key.since_ms)
        poses.push_back(poses_of(path.length, size.key.profile.transfer));
    cursor = page.next_cursor;
  } while (!cursor.empty());
  return poses;
}

std::string megabytes(std::size_t bytes) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20U;
  return std::to_string((bytes + kMegabyte - 1) / kMegabyte) + " MB";
}

}  // namespace

FitNeed need_at_most(const FitSize& size) {
  const std::uint64_t longest = max_poses(size.key.profile.transfer);
  std::uint64_t poses = 0;
  for (const std::uint64_t paths : size.wanted)
    poses += paths * longest;
  return need_of(size, poses, longest);
}

FitNeed need_by_length(const FitSize& size, const store::ExperienceStore& store,
                       const std::stop_token& stop) {
  std::uint64_t poses = 0, longest = 0;
  for (std::size_t i = 0; i < size.experience.size(); ++i) {
    std::vector<std::uint64_t> of_source =
        poses_of_source(size, size.experience[i].robot, store, stop);
    std::ranges::sort(of_source, std::greater<>());
    of_source.resize(std::min<std::size_t>(of_source.size(), size.wanted[i]));
    for (const std::uint64_t of_path : of_source) {
      poses += of_path;
      longest = std::max(longest, of_path);
    }
  }
  return need_of(size, poses, longest);
}

std::size_t bytes_of_configuration(Eigen::Index dof) {
  // As transferred, pooled, in blocks, in blocks of the paths that are not held out; beside it:
  // pose, solution, weight, path, its place among the distinct ones.
  constexpr std::size_t kCopies = 4, kBeside = 96;
  return kCopies * sizeof(double) * static_cast<std::size_t>(dof) + kBeside;
}

std::string describe(const FitNeed& need, std::size_t max_bytes) {
  return "a fit could need " + megabytes(need.bytes) + ": " + std::to_string(need.paths) +
         " paths with up to " + std::to_string(need.poses) + " poses, " +
         std::to_string(need.solutions) + " configurations of " + std::to_string(need.dof) +
         " joints each; the limit is " + megabytes(max_bytes) +
         " (kinshipd --fit-memory-mb). Ask for less: lower max_poses_per_path, max_solutions or "
         "tracks of the profile, raise its pose_spacing, or choose fewer sources or a later date";
}

}  // namespace kinship::fitting
