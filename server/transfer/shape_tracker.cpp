#include "server/transfer/shape_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "robots/inverse/solver.hpp"
#include "server/transfer/shape_lanes.hpp"

namespace kinship::transfer {
namespace {

constexpr double kCandidateDistance = 0.3;  // joint units
constexpr int kStartShapeSteps = 4;         // times as many at the start as at each further pose
constexpr int kAskedTogether = 8;           // poses: as many as a filter answers at once

inverse::CounterGenerator generator_of(const PathPoses& poses, std::uint64_t seed) {
  std::uint64_t key = seed;
  for (const Eigen::Isometry3d& T_base_transfer : poses.T_base_transfer)
    key = inverse::CounterGenerator(key, T_base_transfer).next();
  return inverse::CounterGenerator(key);
}

}  // namespace

ShapeTracker::ShapeTracker(const ArmPair& pair, const PathPoses& poses,
                           const TransferParameters& parameters, std::uint64_t seed,
                           CountedFilters& filters)
    : pair_(pair),
      poses_(poses),
      parameters_(parameters),
      seed_(seed),
      filters_(filters),
      generator_(generator_of(poses, seed)),
      candidates_(poses.T_base_transfer.size()) {}

std::vector<TrackExtension> ShapeTracker::begin_round() {
  std::vector<TrackExtension> extensions;
  while (extensions.empty()) {
    judge();
    const int left = parameters_.tracks - static_cast<int>(tracks_.size());
    // No more than would have been made one after the other.
    const int count = std::min(left, kTriesPerTrack - idle_);
    if (count <= 0)
      break;
    for (int i = 0; i < count; ++i) {
      round_.push_back(make_try());
      const Try& made = round_.back();
      if (made.along.size() > 0)
        extensions.push_back({round_.size() - 1, 0, made.start, made.along.col(made.start)});
    }
  }
  extensions_left_ = extensions.size();
  return extensions;
}

void ShapeTracker::judge() {
  const double least = parameters_.least_coverage * static_cast<double>(poses_.size());
  for (Try& made : round_) {
    const Eigen::Index covered = made.last - made.first + 1;
    came_through_ += covered == poses_.size() ? 1U : 0U;
    ++idle_;
    if (covered == 0 || static_cast<double>(covered) < least)
      continue;
    tracks_.push_back({made.first, made.along.middleCols(made.first, covered)});
    idle_ = 0;
  }
  round_.clear();
}

ShapeTracker::Try ShapeTracker::make_try() {
  ++tried_;
  const auto start =
      std::min(static_cast<Eigen::Index>(generator_.uniform() * static_cast<double>(poses_.size())),
               poses_.size() - 1);
  const Eigen::Index chosen = choose_start(start);
  if (chosen < 0)
    return {start, start, start - 1, {}};  // covers nothing
  Try made{start, start, start, Eigen::MatrixXd(pair_.target().dof(), poses_.size())};
  made.along.col(start) = candidates(start).configurations.col(chosen);
  return made;
}

bool ShapeTracker::take(TrackExtension& extension, const inverse::JointVector& q,
                        const Eigen::Ref<const Eigen::VectorXd>& found) {
  if (extension.direction == 0 && filters_.keep_ahead(found) == 0)
    return false;
  extension.q = q;
  extension.pose += extension.direction;
  round_[extension.of_round].along.col(extension.pose) = found;
  if (extension.direction == 0)
    return true;
  ++extension.unasked;
  return extension.unasked < kAskedTogether || ask(extension);
}

bool ShapeTracker::ask(TrackExtension& extension) {
  Try& made = round_[extension.of_round];
  const int count = std::exchange(extension.unasked, 0);
  const Eigen::Index first = extension.pose - extension.direction * (count - 1);
  Eigen::MatrixXd asked(made.along.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i)
    asked.col(i) = made.along.col(first + extension.direction * i);
  const Eigen::Index kept = filters_.keep_ahead(asked);
  if (kept > 0) {
    const Eigen::Index last = first + extension.direction * (kept - 1);
    made.first = std::min(made.first, last);
    made.last = std::max(made.last, last);
  }
  return kept == count;
}

std::vector<TrackExtension> ShapeTracker::end(TrackExtension& extension) {
  ask(extension);
  --extensions_left_;
  if (extension.direction == 0) {
    const Try& made = round_[extension.of_round];
    extensions_left_ += 2;
    return {{extension.of_round, 1, made.start, made.along.col(made.start)},
            {extension.of_round, -1, made.start, made.along.col(made.start)}};
  }
  if (extensions_left_ > 0)
    return {};
  return begin_round();
}

double ShapeTracker::most_motion(const TrackExtension& extension) const {
  const Eigen::Index before = std::min(extension.pose, extension.pose + extension.direction);
  return kMaxMotion * poses_.source_motion[before] + kSpareMotion;
}

int ShapeTracker::start_steps() const noexcept {
  return kStartShapeSteps * parameters_.shape_steps;
}

const ShapeTracker::Candidates& ShapeTracker::candidates(Eigen::Index pose) {
  const auto at = static_cast<std::size_t>(pose);
  std::optional<Candidates>& known = candidates_[at];
  if (!known) {
    const kinematics::Chain& target = pair_.target();
    Eigen::MatrixXd found =
        pair_.target_solver()
            .solve(poses_.T_base_transfer[at] * target.T_tip_transfer().inverse(),
                   {.max_solutions = parameters_.track_candidates,
                    .min_distance = kCandidateDistance,
                    .seed = seed_,
                    .exhaustive = false})
            .configurations;
    known.emplace();
    known->configurations = passed(std::move(found), filters_);
    known->distances_m = shape_distances_m(pair_, known->configurations, poses_.source_shapes[at]);
  }
  return *known;
}

Eigen::Index ShapeTracker::choose_start(Eigen::Index pose) {
  const Eigen::VectorXd& distances_m = candidates(pose).distances_m;
  Eigen::Index best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < distances_m.size(); ++i) {
    const double distance = distances_m[i] + parameters_.shape_noise * normal();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

double ShapeTracker::normal() {  // Box and Muller (1958); 1 - u lies in (0, 1]
  const double radius = std::sqrt(-2 * std::log(1 - generator_.uniform()));
  return radius * std::cos(2 * std::numbers::pi * generator_.uniform());
}

}  // namespace kinship::transfer
