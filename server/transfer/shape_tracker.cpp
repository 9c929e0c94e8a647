#include "server/transfer/shape_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/inverse/joint_space.hpp"
#include "server/transfer/shape_pull.hpp"

namespace kinship::transfer {
namespace {

constexpr double kCandidateDistance = 0.3;  // joint units
constexpr int kIterations = 15;             // of one step along the path
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
      candidates_(poses.T_base_transfer.size()) {}

std::vector<Track> ShapeTracker::find_tracks() {
  std::vector<Track> tracks;
  const double least = parameters_.least_coverage * static_cast<double>(poses_.size());
  const auto wanted = static_cast<std::size_t>(parameters_.tracks);
  for (int idle = 0; idle < kTriesPerTrack && tracks.size() < wanted; ++idle) {
    std::optional<Track> track = try_track();
    if (!track || static_cast<double>(track->configurations.cols()) < least)
      continue;
    tracks.push_back(std::move(*track));
    idle = -1;
  }
  return tracks;
}

std::optional<Track> ShapeTracker::try_track() {
  ++tried_;
  const auto start =
      std::min(static_cast<Eigen::Index>(generator_.uniform() * static_cast<double>(poses_.size())),
               poses_.size() - 1);
  const Eigen::Index chosen = choose_start(start);
  if (chosen < 0)
    return std::nullopt;
  Eigen::MatrixXd along(pair_.target().dof(), poses_.size());
  along.col(start) = pulled_start(start, candidates(start).col(chosen));
  Eigen::Index last = start;
  for (inverse::JointVector q = along.col(start);
       last + 1 < poses_.size() && follow(last, last + 1, q, along.col(last + 1));)
    ++last;
  Eigen::Index first = start;
  for (inverse::JointVector q = along.col(start);
       first > 0 && follow(first, first - 1, q, along.col(first - 1));)
    --first;
  return Track{first, along.middleCols(first, last - first + 1)};
}

const Eigen::MatrixXd& ShapeTracker::candidates(Eigen::Index pose) {
  std::optional<Eigen::MatrixXd>& known = candidates_[static_cast<std::size_t>(pose)];
  if (!known) {
    const kinematics::Chain& target = pair_.target();
    Eigen::MatrixXd found =
        inverse::inverse(target,
                         poses_.T_base_transfer[static_cast<std::size_t>(pose)] *
                             target.T_tip_transfer().inverse(),
                         {.max_solutions = parameters_.track_candidates,
                          .min_distance = kCandidateDistance,
                          .seed = seed_})
            .configurations;
    known = passed(std::move(found), filters_);
  }
  return *known;
}

Eigen::Index ShapeTracker::choose_start(Eigen::Index pose) {
  const Eigen::MatrixXd& configurations = candidates(pose);
  Eigen::Index best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    const double distance = shape_distance(arm_shape(pair_.target(), configurations.col(i)),
                                           poses_.source_shapes[static_cast<std::size_t>(pose)]) +
                            parameters_.shape_noise * normal();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

Eigen::VectorXd ShapeTracker::pulled_start(Eigen::Index pose, const Eigen::VectorXd& candidate) {
  const auto at = static_cast<std::size_t>(pose);
  inverse::JointVector q = candidate;
  pull_to_shape(pair_, poses_.T_base_transfer[at], poses_.source_shapes[at],
                kStartShapeSteps * parameters_.shape_steps, q);
  Eigen::VectorXd pulled = q;
  const bool is_fit = inverse::normalize(pair_.target(), pulled) &&
                      inverse::reaches(pair_.target(), poses_.T_base_transfer[at], pulled) &&
                      filters_.keep(pulled);
  return is_fit ? pulled : candidate;
}

bool ShapeTracker::follow(Eigen::Index from, Eigen::Index to, inverse::JointVector& q,
                          Eigen::Ref<Eigen::VectorXd> found) {
  const auto at = static_cast<std::size_t>(to);
  const Eigen::Isometry3d& T_base_transfer = poses_.T_base_transfer[at];
  inverse::JointVector next = q;
  const double squared = pair_.target_descent().run(T_base_transfer, inverse::Descent::Limits::Hold,
                                                    kIterations, next);
  const double most = kMostMotion * poses_.source_motion[std::min(from, to)] + kSpareMotion;
  if (!(squared <= inverse::kPoseTolerance * inverse::kPoseTolerance) ||
      !((next - q).norm() <= most))
    return false;
  inverse::JointVector pulled = next;
  pull_to_shape(pair_, T_base_transfer, poses_.source_shapes[at], parameters_.shape_steps, pulled);
  if ((pulled - q).norm() <= most)
    next = pulled;
  found = next;
  if (!inverse::normalize(pair_.target(), found) ||
      !inverse::reaches(pair_.target(), T_base_transfer, found) || !filters_.keep(found))
    return false;
  q = next;
  return true;
}

double ShapeTracker::normal() {  // Box and Muller (1958); 1 - u lies in (0, 1]
  const double radius = std::sqrt(-2 * std::log(1 - generator_.uniform()));
  return radius * std::cos(2 * std::numbers::pi * generator_.uniform());
}

}  // namespace kinship::transfer
