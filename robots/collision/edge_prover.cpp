#include "robots/collision/edge_prover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr double kMotionRounding_m = 1e-9;

/// The last moving joint that moves both of what two joints move; -1: none does.
int joint_before_both(const kinematics::Chain& chain, int a, int b) {
  while (a != b)
    (a > b ? a : b) = chain.joint_before(std::max(a, b));
  return a;
}

}  // namespace

EdgeProver::EdgeProver(const RobotSolids& robot, const Surroundings& surroundings)
    : robot_(robot),
      bodies_(bodies_among(robot, surroundings)),
      pairs_(moving_pairs(bodies_, robot.parts().unchecked, surroundings)),
      bounds_(robot.parts().chain, bodies_),
      motion_m_(robot.parts().chain.moving_joints() + 1, static_cast<Eigen::Index>(bodies_.size())),
      body_stamps_(bodies_.size(), 0) {
  for (auto& [first, second] : pairs_) {
    if (bodies_[first].joint > bodies_[second].joint)
      std::swap(first, second);
    joints_before_both_.push_back(
        joint_before_both(robot.parts().chain, bodies_[first].joint, bodies_[second].joint));
  }
  for (const BodyPair& pair : standing_pairs(bodies_, surroundings))
    if (touch(bodies_[pair.first].solid, bodies_[pair.first].T_joint_body,
              bodies_[pair.second].solid, bodies_[pair.second].T_joint_body)) {
      standing_contact_ = pair;
      break;
    }
}

EdgeProver::EdgeProver(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                       const Surroundings& surroundings)
    : EdgeProver(RobotSolids(chain, shapes), surroundings) {}

void EdgeProver::check(const Eigen::Ref<const Eigen::VectorXd>& from,
                       const Eigen::Ref<const Eigen::VectorXd>& to,
                       const EdgeProofOptions& options) const {
  const Eigen::Index dof = robot_.parts().chain.dof();
  if (from.size() != dof || to.size() != dof)
    throw std::invalid_argument("EdgeProver: " + std::to_string(from.size()) + " and " +
                                std::to_string(to.size()) + " values for " + std::to_string(dof) +
                                " joints");
  if (!from.allFinite() || !to.allFinite())
    throw std::invalid_argument("EdgeProver: q is not finite");
  if (!(options.clearance_m > 0 && options.clearance_m <= 1))
    throw std::invalid_argument("EdgeProver: clearance of " + std::to_string(options.clearance_m) +
                                " m, must be above 0 and at most 1 m");
}

EdgeProof EdgeProver::prove(const Eigen::Ref<const Eigen::VectorXd>& from,
                            const Eigen::Ref<const Eigen::VectorXd>& to,
                            const EdgeProofOptions& options) {
  check(from, to, options);
  from_ = from;
  change_ = to - from;
  clearance_m_ = options.clearance_m;
  proof_ = {};
  proof_.least_clearance_m = std::numeric_limits<double>::infinity();
  if (standing_contact_) {
    const auto& [first, second] = *standing_contact_;
    proof_.refutation = {from, 0, bodies_[first].name, bodies_[second].name, 0};
    proof_.least_clearance_m = 0;
    return proof_;
  }
  used_places_ = 0;
  pieces_.clear();
  open_.resize(pairs_.size());
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair)
    open_[pair] = pair;
  const std::size_t start = add_place(0, 0, open_.size());
  const std::size_t end = add_place(1, 0, open_.size());
  pieces_.push_back({start, end, 0, open_.size()});
  // In the order in which they come: the longest pieces first, which find early what is in the way.
  for (std::size_t next = 0; next < pieces_.size() && !proof_.refutation; ++next)
    look_at(pieces_[next]);
  return proof_;
}

void EdgeProver::look_at(const Piece piece) {
  bound_motion(piece);
  const std::size_t first_left = open_.size();
  for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
    const std::size_t pair = open_[i];
    const bool apart = is_apart(piece, pair);
    if (proof_.refutation)
      return;
    if (!apart)
      open_.push_back(pair);
  }
  const std::size_t left = open_.size() - first_left;
  if (left == 0)
    return;
  const double middle = (places_[piece.from].share + places_[piece.to].share) / 2;
  const std::size_t place = add_place(middle, first_left, left);
  pieces_.push_back({piece.from, place, first_left, left});
  pieces_.push_back({place, piece.to, first_left, left});
}

std::size_t EdgeProver::add_place(double share, std::size_t first, std::size_t count) {
  ++proof_.configurations;
  if (used_places_ == places_.size()) {
    Place& made = places_.emplace_back();
    made.T_base_bodies = standing_poses(bodies_);
    made.reach_m.setZero(motion_m_.rows() - 1, motion_m_.cols());
    made.distances.resize(pairs_.size());
  }
  Place& place = places_[used_places_];
  place.share = share;
  place.q = from_ + share * change_;
  kinematics::joint_poses(robot_.parts().chain, place.q, place.T_base_joints);
  ++stamp_;
  for (std::size_t i = first; i < first + count; ++i) {
    const std::size_t pair = open_[i];
    const auto [a, b] = pairs_[pair];
    for (const std::size_t index : {a, b}) {
      const Body& body = bodies_[index];
      if (body.joint < 0 || body_stamps_[index] == stamp_)
        continue;
      body_stamps_[index] = stamp_;
      place.T_base_bodies[index] =
          place.T_base_joints[static_cast<std::size_t>(body.joint)] * body.T_joint_body;
      bounds_.measure(index, place.T_base_joints,
                      place.reach_m.col(static_cast<Eigen::Index>(index)));
    }
    place.distances[pair] = {cheap_distance_m(bodies_[a].solid, place.T_base_bodies[a],
                                              bodies_[b].solid, place.T_base_bodies[b]),
                             false};
  }
  return used_places_++;
}

void EdgeProver::bound_motion(const Piece& piece) {
  const Place &from = places_[piece.from], &to = places_[piece.to];
  ++stamp_;
  const Eigen::VectorXd change = (to.share - from.share) * change_;
  for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
    const auto [a, b] = pairs_[open_[i]];
    for (const std::size_t body : {a, b}) {
      if (bodies_[body].joint == joints_before_both_[open_[i]] || body_stamps_[body] == stamp_)
        continue;
      body_stamps_[body] = stamp_;
      const auto column = static_cast<Eigen::Index>(body);
      bounds_.bound(body, change, from.reach_m.col(column), to.reach_m.col(column),
                    motion_m_.col(column));
    }
  }
}

bool EdgeProver::is_apart(const Piece& piece, std::size_t pair) {
  const auto [a, b] = pairs_[pair];
  const int both = joints_before_both_[pair];
  double motion_m = motion_m_(both + 1, static_cast<Eigen::Index>(b)) + kMotionRounding_m;
  if (bodies_[a].joint != both)
    motion_m += motion_m_(both + 1, static_cast<Eigen::Index>(a));
  Place &from = places_[piece.from], &to = places_[piece.to];
  const auto are_apart = [&] { return motion_m < from.distances[pair].m + to.distances[pair].m; };
  for (Place* place : {&from, &to})  // what may be too near is refused, however little it moves
    if (!place->distances[pair].is_close && place->distances[pair].m <= clearance_m_ &&
        !measure(*place, pair, std::numeric_limits<double>::infinity()))
      return false;
  if (are_apart())
    return true;
  const auto farthest = [a = a, b = b](const Place& place) {  // Clang 14 captures no binding
    return (place.T_base_bodies[a].translation() - place.T_base_bodies[b].translation()).norm();
  };
  if (motion_m > farthest(from) + farthest(to))
    return false;  // hardly helped by measuring, of shapes not at all
  for (Place* place : {&from, &to}) {
    const double other_m = (place == &from ? to : from).distances[pair].m;
    if (!place->distances[pair].is_close &&
        !measure(*place, pair, motion_m - other_m + kMotionRounding_m))
      return false;
    if (are_apart())
      return true;
  }
  return false;
}

bool EdgeProver::measure(Place& place, std::size_t pair, double enough_m) {
  const auto [a, b] = pairs_[pair];
  Distance& distance = place.distances[pair];
  const double close_m = close_distance_m(bodies_[a].solid, place.T_base_bodies[a],
                                          bodies_[b].solid, place.T_base_bodies[b], enough_m);
  distance = {std::max(distance.m, close_m), close_m < enough_m};
  ++proof_.distances;
  if (!distance.is_close)
    return true;
  proof_.least_clearance_m = std::min(proof_.least_clearance_m, distance.m);
  if (distance.m > clearance_m_)
    return true;
  proof_.refutation = {place.q, place.share, bodies_[a].name, bodies_[b].name, distance.m};
  return false;
}

}  // namespace kinship::collision
