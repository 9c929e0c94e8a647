#include "server/transfer/shape_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robots/inverse/solver.hpp"

namespace kinship::transfer {
namespace {

constexpr double kCandidateDistance = 0.3;  // joint units
constexpr int kStartShapeSteps = 4;         // times as many at the start as at each further pose

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
      candidates_(poses.T_base_transfer.size()),
      lanes_(pair),
      space_(pair.target()) {}

std::vector<Track> ShapeTracker::find_tracks() {
  std::vector<Track> tracks;
  const double least = parameters_.least_coverage * static_cast<double>(poses_.size());
  const int wanted = parameters_.tracks;
  for (int idle = 0; idle < kTriesPerTrack && static_cast<int>(tracks.size()) < wanted;) {
    const int left = wanted - static_cast<int>(tracks.size());
    // No more than would have been made one after the other.
    const int count = std::min({left, kTriesPerTrack - idle, kTriesAtOnce});
    for (Try& attempt : make_tries(count)) {
      const Eigen::Index covered = attempt.last - attempt.first + 1;
      came_through_ += covered == poses_.size() ? 1U : 0U;
      ++idle;
      if (covered == 0 || static_cast<double>(covered) < least)
        continue;
      tracks.push_back({attempt.first, attempt.along.middleCols(attempt.first, covered)});
      idle = 0;
    }
  }
  return tracks;
}

std::vector<ShapeTracker::Try> ShapeTracker::make_tries(int count) {
  std::vector<Try> tries;
  for (int i = 0; i < count; ++i) {
    ++tried_;
    const auto start = std::min(
        static_cast<Eigen::Index>(generator_.uniform() * static_cast<double>(poses_.size())),
        poses_.size() - 1);
    tries.push_back({start, start - 1, {}});  // covers nothing
    const Eigen::Index chosen = choose_start(start);
    if (chosen < 0)
      continue;
    tries.back().last = start;
    tries.back().along.resize(pair_.target().dof(), poses_.size());
    tries.back().along.col(start) = candidates(start).configurations.col(chosen);
  }
  pull_starts(tries);
  follow_to_both_ends(tries);
  return tries;
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
                    .seed = seed_})
            .configurations;
    known.emplace();
    known->configurations = passed(std::move(found), filters_);
    known->distances_m = lanes_.distances_m(known->configurations, poses_.source_shapes[at]);
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

void ShapeTracker::aim(int lane, Eigen::Index pose) {
  const auto at = static_cast<std::size_t>(pose);
  lanes_.aim(lane, poses_.T_base_transfer[at], poses_.source_shapes[at]);
}

void ShapeTracker::pull_starts(std::vector<Try>& tries) {
  unsigned started = 0;
  for (std::size_t i = 0; i < tries.size(); ++i) {
    if (tries[i].along.size() == 0)
      continue;
    const int lane = static_cast<int>(i);
    aim(lane, tries[i].first);
    lanes_.put(lane, tries[i].along.col(tries[i].first));
    started |= 1U << i;
  }
  lanes_.pull(started, kStartShapeSteps * parameters_.shape_steps);
  Eigen::MatrixXd pulled(pair_.target().dof(), ShapeLanes::kCount);
  for (int lane = 0; lane < ShapeLanes::kCount; ++lane) {
    pulled.col(lane) = lanes_.at(lane);
    if (!space_.normalize(pulled.col(lane).data()))
      started &= ~(1U << static_cast<unsigned>(lane));
  }
  const unsigned right = lanes_.verified(started, pulled);
  for (std::size_t i = 0; i < tries.size(); ++i)
    if (const inverse::JointVector q = pulled.col(static_cast<Eigen::Index>(i));
        (right >> i & 1U) != 0 && filters_.keep(q))
      tries[i].along.col(tries[i].first) = q;
}

void ShapeTracker::follow_to_both_ends(std::vector<Try>& tries) {
  std::vector<Walker> walkers;
  for (std::size_t i = 0; i < tries.size(); ++i)
    if (tries[i].along.size() > 0)
      for (const Eigen::Index direction : {1, -1})
        walkers.push_back({i, direction, tries[i].first, tries[i].along.col(tries[i].first)});
  for (unsigned walking = (1U << walkers.size()) - 1; walking != 0;)
    walking = walk(walkers, walking, tries);
}

unsigned ShapeTracker::walk(std::vector<Walker>& walkers, unsigned walking,
                            std::vector<Try>& tries) {
  const auto is_in = [](unsigned lanes, std::size_t i) { return (lanes >> i & 1U) != 0; };
  const auto leave = [](unsigned& lanes, std::size_t i) { lanes &= ~(1U << i); };
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    const Eigen::Index to = walkers[i].pose + walkers[i].direction;
    if (to < 0 || to >= poses_.size())
      leave(walking, i);
    if (!is_in(walking, i))
      continue;
    aim(static_cast<int>(i), to);
    lanes_.put(static_cast<int>(i), walkers[i].q);
  }
  walking = lanes_.reach(walking);
  const auto most = [&](const Walker& walker) {
    const Eigen::Index before = std::min(walker.pose, walker.pose + walker.direction);
    return kMostMotion * poses_.source_motion[before] + kSpareMotion;
  };
  std::vector<inverse::JointVector> next(walkers.size());
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    next[i] = lanes_.at(static_cast<int>(i));
    if (is_in(walking, i) && !((next[i] - walkers[i].q).norm() <= most(walkers[i])))
      leave(walking, i);
  }
  lanes_.pull(walking, parameters_.shape_steps);
  Eigen::MatrixXd found = Eigen::MatrixXd::Zero(pair_.target().dof(), ShapeLanes::kCount);
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    if (!is_in(walking, i))
      continue;
    const inverse::JointVector pulled = lanes_.at(static_cast<int>(i));
    if ((pulled - walkers[i].q).norm() <= most(walkers[i]))
      next[i] = pulled;
    found.col(static_cast<Eigen::Index>(i)) = next[i];
    if (!space_.normalize(found.col(static_cast<Eigen::Index>(i)).data()))
      leave(walking, i);
  }
  walking = lanes_.verified(walking, found);
  for (std::size_t i = 0; i < walkers.size(); ++i) {
    if (!is_in(walking, i))
      continue;
    if (!filters_.keep(found.col(static_cast<Eigen::Index>(i)))) {
      leave(walking, i);
      continue;
    }
    Walker& walker = walkers[i];
    walker.q = next[i];
    walker.pose += walker.direction;
    Try& attempt = tries[walker.index];
    attempt.along.col(walker.pose) = found.col(static_cast<Eigen::Index>(i));
    (walker.direction > 0 ? attempt.last : attempt.first) = walker.pose;
  }
  return walking;
}

double ShapeTracker::normal() {  // Box and Muller (1958); 1 - u lies in (0, 1]
  const double radius = std::sqrt(-2 * std::log(1 - generator_.uniform()));
  return radius * std::cos(2 * std::numbers::pi * generator_.uniform());
}

}  // namespace kinship::transfer
