#include "robots/collision/edge_prover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/number_text.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr double kMotionRounding_m = 1e-9;
// The lanes' first parts are so long that a body moves by so much in half of one, m, and are cut
// into so many, so often, where they tell nothing.
constexpr double kFirstGrowth_m = 0.02;
constexpr int kCuts = 4, kLevels = 3;
constexpr double kFarthest_m = 1e4;  // on one edge: no robot moves farther

}  // namespace

void check_clearance(const std::string& name, double clearance_m) {
  if (!(clearance_m >= kLeastClearance_m && clearance_m <= kLargestRoom_m))
    throw Failure(invalid_input(name + " is " + number_text(clearance_m) + " m, must be from " +
                                number_text(kLeastClearance_m) + " to " +
                                number_text(kLargestRoom_m) + " m"));
}

EdgeProver::EdgeProver(CollisionWorld& world)
    : world_(world),
      pairs_(world.pairs_),
      bounds_(world.robot_.parts().chain, world.bodies_),
      middles_(world.robot_.parts().chain.dof(), kLanes),
      changes_(middles_),
      body_stamps_(world.bodies_.size(), 0) {
  const kinematics::Chain& chain = world.robot_.parts().chain;
  for (std::size_t body = 0; body < world.bodies_.size(); ++body) {
    index_of_moving_.push_back(world.bodies_[body].joint < 0 ? -1
                                                             : static_cast<int>(moving_.size()));
    if (world.bodies_[body].joint >= 0)
      moving_.push_back(body);
  }
  motion_m_.setZero(chain.moving_joints() + 1, static_cast<Eigen::Index>(world.bodies_.size()));
  for (auto& [first, second] : pairs_)
    if (world.bodies_[first].joint > world.bodies_[second].joint)
      std::swap(first, second);
  std::ranges::sort(pairs_);
  for (const auto& [first, second] : pairs_)
    joints_before_both_.push_back(
        chain.joint_before_both(world.bodies_[first].joint, world.bodies_[second].joint));
}

void EdgeProver::begin(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                       const EdgeProofOptions& options) {
  if (qs.rows() != middles_.rows())
    throw std::invalid_argument("EdgeProver: " + std::to_string(qs.rows()) + " values for " +
                                std::to_string(middles_.rows()) + " joints");
  if (!qs.allFinite())
    throw std::invalid_argument("EdgeProver: q is not finite");
  check_clearance("clearance", options.clearance_m);
  clearances_ = {options.clearance_m, std::min(options.clearance_m, kOwnClearance_m)};
}

bool EdgeProver::is_own(const BodyPair& pair) const {
  return world_.bodies_[pair.first].kind != BodyKind::Obstacle &&
         world_.bodies_[pair.second].kind != BodyKind::Obstacle;
}

double EdgeProver::clearance_m(const BodyPair& pair) const {
  return is_own(pair) ? clearances_.moving_m : clearances_.standing_m;
}

EdgeProof EdgeProver::prove(const Eigen::Ref<const Eigen::VectorXd>& from,
                            const Eigen::Ref<const Eigen::VectorXd>& to,
                            const EdgeProofOptions& options) {
  return prove_all(from, to, options).front();
}

const std::vector<EdgeProof>& EdgeProver::prove_all(const Eigen::Ref<const Eigen::MatrixXd>& from,
                                                    const Eigen::Ref<const Eigen::MatrixXd>& to,
                                                    const EdgeProofOptions& options) {
  begin(from, options);
  begin(to, options);
  if (from.cols() != to.cols())
    throw std::invalid_argument("EdgeProver: " + std::to_string(from.cols()) + " starts and " +
                                std::to_string(to.cols()) + " ends");
  from_ = from;
  change_ = to - from;
  proofs_.assign(static_cast<std::size_t>(from.cols()), {});
  for (EdgeProof& proof : proofs_)
    proof.least_clearance_m = std::numeric_limits<double>::infinity();
  if (!world_.standing_contacts_.empty()) {
    const auto [first, second] = world_.names(world_.standing_contacts_.front());
    for (std::size_t edge = 0; edge < proofs_.size(); ++edge) {
      proofs_[edge].refutation = {from.col(static_cast<Eigen::Index>(edge)), 0, first, second, 0};
      proofs_[edge].least_clearance_m = 0;
    }
    return proofs_;
  }
  used_places_ = 0;
  pieces_.clear();
  open_.clear();
  ask_lanes();
  // In the order in which they come: the longest pieces first, which find obstacles early.
  for (std::size_t next = 0; next < pieces_.size(); ++next)
    if (!proofs_[pieces_[next].edge].refutation)
      look_at(pieces_[next]);
  return proofs_;
}

void EdgeProver::ask_lanes() {
  parts_.clear();
  doubts_.clear();
  for (std::size_t edge = 0; edge < proofs_.size(); ++edge) {
    const auto column = static_cast<Eigen::Index>(edge);
    const double farthest_m =
        bounds_.farthest_m(from_.col(column), from_.col(column) + change_.col(column));
    if (!(farthest_m <= kFarthest_m))
      throw Failure(invalid_input("on an edge a body may move by " + number_text(farthest_m) +
                                  " m, of which at most " + number_text(kFarthest_m) +
                                  " m are looked at"));
    const double count = std::max(1.0, std::ceil(farthest_m / (2 * kFirstGrowth_m)));
    for (double i = 0; i < count; ++i)
      parts_.push_back({edge, i / count, (i + 1) / count, 0, 0});
  }
  for (int level = 1; level <= kLevels && !parts_.empty(); ++level) {
    rest_.clear();
    for (std::size_t first = 0; first < parts_.size(); first += kLanes)
      ask_parts(
          std::span(parts_).subspan(first, std::min<std::size_t>(kLanes, parts_.size() - first)),
          level == kLevels || !world_.lanes_.has_room());
    std::swap(parts_, rest_);
  }
}

void EdgeProver::ask_parts(std::span<const Part> parts, bool is_last) {
  const auto count = static_cast<Eigen::Index>(parts.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    const Part& part = parts[static_cast<std::size_t>(i)];
    const auto column = static_cast<Eigen::Index>(part.edge);
    middles_.col(i) = from_.col(column) + (part.from + part.to) / 2 * change_.col(column);
    ++proofs_[part.edge].configurations;
    changes_.col(i) = (part.to - part.from) / 2 * change_.col(column);
  }
  const LaneAnswer answer =
      world_.lanes_.ask_grown(middles_.leftCols(count), changes_.leftCols(count), clearances_,
                              LaneScope::Each, pairs_of(parts));
  for (int lane = 0; lane < static_cast<int>(count); ++lane)
    if (const Part& part = parts[static_cast<std::size_t>(lane)];
        (answer.maybe >> lane & 1U) != 0 && !proofs_[part.edge].refutation)
      open_part(part, lane, (answer.surely >> lane & 1U) != 0, is_last);
}

std::span<const LaneDoubt> EdgeProver::pairs_of(std::span<const Part> parts) {
  asked_.clear();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].count == 0)
      return {};
    for (const LaneDoubt& open : std::span(doubts_).subspan(parts[i].first, parts[i].count)) {
      const auto known = std::ranges::find_if(asked_, [&](const LaneDoubt& other) {
        return other.body == open.body && other.obstacle == open.obstacle &&
               other.other == open.other;
      });
      if (known != asked_.end()) {
        known->lanes |= 1U << i;
        continue;
      }
      if (asked_.size() == kLaneDoubts)
        return {};
      asked_.push_back({1U << i, open.body, open.obstacle, open.other});
    }
  }
  return asked_;
}

void EdgeProver::open_part(const Part& part, int lane, bool surely, bool is_last) {
  if (surely && find_contact(part.edge, (part.from + part.to) / 2))
    return;
  if (!is_last && !surely) {
    const std::size_t first = doubts_.size();
    world_.lanes_.add_doubts(lane, doubts_);
    const double share = (part.to - part.from) / kCuts;
    for (int i = 0; i < kCuts; ++i)
      rest_.push_back({part.edge, part.from + i * share, part.from + (i + 1) * share, first,
                       doubts_.size() - first});
    return;
  }
  const std::size_t first = open_.size();
  if (surely || !open_doubtful(lane))
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair)
      open_.push_back(pair);
  const std::size_t open = open_.size() - first;
  const bool is_next = used_places_ > 0 && places_[used_places_ - 1].edge == part.edge &&
                       places_[used_places_ - 1].share == part.from;
  const std::size_t from = is_next ? used_places_ - 1 : add_place(part.edge, part.from);
  pieces_.push_back({part.edge, from, add_place(part.edge, part.to), first, open});
}

bool EdgeProver::find_contact(std::size_t edge, double share) {
  Place& place = places_[add_place(edge, share)];
  for (std::size_t pair = 0; pair < pairs_.size(); ++pair) {
    const auto [a, b] = pairs_[pair];
    const Solid &first = world_.bodies_[a].solid, &second = world_.bodies_[b].solid;
    const double apart_m =
        (pose_at(place, a).translation() - pose_at(place, b).translation()).norm();
    if (!first.is_hollow() && !second.is_hollow() &&
        apart_m <= first.radius_m() + second.radius_m() &&
        !measure(place, pair, std::numeric_limits<double>::infinity()))
      return true;
  }
  return false;
}

bool EdgeProver::open_doubtful(int lane) {
  if (!world_.lanes_.doubtful_pairs(lane, doubtful_))
    return false;
  for (auto [a, b] : doubtful_) {
    if (world_.bodies_[a].joint > world_.bodies_[b].joint)
      std::swap(a, b);
    const auto at = std::ranges::lower_bound(pairs_, BodyPair(a, b));
    open_.push_back(static_cast<std::size_t>(at - pairs_.begin()));
  }
  return true;
}

void EdgeProver::look_at(const Piece piece) {
  bound_motion(piece);
  const std::size_t first_left = open_.size();
  for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
    const std::size_t pair = open_[i];
    const bool apart = is_apart(piece, pair);
    if (proofs_[piece.edge].refutation)
      return;
    if (!apart)
      open_.push_back(pair);
  }
  const std::size_t left = open_.size() - first_left;
  if (left == 0)
    return;
  const double middle = (places_[piece.from].share + places_[piece.to].share) / 2;
  const std::size_t place = add_place(piece.edge, middle);
  pieces_.push_back({piece.edge, piece.from, place, first_left, left});
  pieces_.push_back({piece.edge, place, piece.to, first_left, left});
}

std::size_t EdgeProver::add_place(std::size_t edge, double share) {
  ++proofs_[edge].configurations;
  if (used_places_ == places_.size()) {
    Place& made = places_.emplace_back();
    made.T_base_bodies.resize(moving_.size());
    made.reach_m.setZero(motion_m_.rows() - 1, static_cast<Eigen::Index>(moving_.size()));
  }
  Place& place = places_[used_places_];
  const auto column = static_cast<Eigen::Index>(edge);
  place.edge = edge;
  place.share = share;
  place.q = from_.col(column) + share * change_.col(column);
  place.has_body.assign(moving_.size(), 0);
  place.distances.assign(pairs_.size(), {});
  kinematics::joint_poses(world_.robot_.parts().chain, place.q, place.T_base_joints);
  return used_places_++;
}

const Eigen::Isometry3d& EdgeProver::pose_at(Place& place, std::size_t body) {
  const int index = index_of_moving_[body];
  if (index < 0)
    return world_.T_base_bodies_[body];
  const auto moving = static_cast<std::size_t>(index);
  Eigen::Isometry3d& T_base_body = place.T_base_bodies[moving];
  if (place.has_body[moving] == 0) {
    place.has_body[moving] = 1;
    const Body& its = world_.bodies_[body];
    T_base_body = place.T_base_joints[static_cast<std::size_t>(its.joint)] * its.T_joint_body;
    bounds_.measure(body, place.T_base_joints, place.reach_m.col(index));
  }
  return T_base_body;
}

EdgeProver::Distance& EdgeProver::distance_at(Place& place, std::size_t pair) {
  Distance& distance = place.distances[pair];
  if (distance.m < 0) {
    const auto [a, b] = pairs_[pair];
    distance = {cheap_distance_m(world_.bodies_[a].solid, pose_at(place, a),
                                 world_.bodies_[b].solid, pose_at(place, b)),
                false};
  }
  return distance;
}

void EdgeProver::bound_motion(const Piece& piece) {
  Place &from = places_[piece.from], &to = places_[piece.to];
  ++stamp_;
  const Eigen::VectorXd change =
      (to.share - from.share) * change_.col(static_cast<Eigen::Index>(piece.edge));
  for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
    distance_at(from, open_[i]);
    distance_at(to, open_[i]);
    const auto [a, b] = pairs_[open_[i]];
    for (const std::size_t body : {a, b}) {
      if (world_.bodies_[body].joint == joints_before_both_[open_[i]] ||
          body_stamps_[body] == stamp_)
        continue;
      body_stamps_[body] = stamp_;
      const int moving = index_of_moving_[body];
      bounds_.bound(body, change, from.reach_m.col(moving), to.reach_m.col(moving),
                    motion_m_.col(static_cast<Eigen::Index>(body)));
    }
  }
}

bool EdgeProver::is_apart(const Piece& piece, std::size_t pair) {
  const auto [a, b] = pairs_[pair];
  const int both = joints_before_both_[pair];
  double motion_m = motion_m_(both + 1, static_cast<Eigen::Index>(b)) + kMotionRounding_m;
  if (world_.bodies_[a].joint != both)
    motion_m += motion_m_(both + 1, static_cast<Eigen::Index>(a));
  Place &from = places_[piece.from], &to = places_[piece.to];
  const double clearance = clearance_m(pairs_[pair]);
  const auto are_apart = [&] { return motion_m < from.distances[pair].m + to.distances[pair].m; };
  for (Place* place : {&from, &to})  // refused if it may be too near, however little it moves
    if (!place->distances[pair].is_close && place->distances[pair].m <= clearance &&
        !measure(*place, pair, std::numeric_limits<double>::infinity()))
      return false;
  if (are_apart())
    return true;
  const auto farthest = [this, a = a, b = b](Place& place) {  // Clang 14 captures no binding
    return (pose_at(place, a).translation() - pose_at(place, b).translation()).norm();
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
  const double close_m = close_distance_m(world_.bodies_[a].solid, pose_at(place, a),
                                          world_.bodies_[b].solid, pose_at(place, b), enough_m);
  distance = {std::max(distance.m, close_m), close_m < enough_m};
  EdgeProof& proof = proofs_[place.edge];
  ++proof.distances;
  if (!distance.is_close)
    return true;
  proof.least_clearance_m = std::min(proof.least_clearance_m, distance.m);
  if (distance.m > clearance_m(pairs_[pair]))
    return true;
  proof.refutation = {place.q, place.share, world_.bodies_[a].name, world_.bodies_[b].name,
                      distance.m};
  return false;
}

Eigen::Index EdgeProver::clear_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                     const EdgeProofOptions& options) {
  begin(qs, options);
  return alike_ahead(qs, true);
}

Eigen::Index EdgeProver::near_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                    const EdgeProofOptions& options) {
  begin(qs, options);
  return alike_ahead(qs, false);
}

bool EdgeProver::are_clear(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                           const EdgeProofOptions& options) {
  begin(qs, options);
  if (!world_.standing_contacts_.empty())
    return false;
  for (Eigen::Index first = 0; first < qs.cols(); first += kLanes) {
    const Eigen::Index count = std::min<Eigen::Index>(kLanes, qs.cols() - first);
    const LaneAnswer answer = world_.lanes_.ask_grown(
        qs.middleCols(first, count), changes_.leftCols(0), clearances_, LaneScope::All);
    if (answer.surely != 0)
      return false;
    for (Eigen::Index i = 0; i < count; ++i)
      if ((answer.maybe >> i & 1U) != 0 && !is_clear(static_cast<int>(i), qs.col(first + i)))
        return false;
  }
  return true;
}

Eigen::Index EdgeProver::alike_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs, bool clear) {
  if (!world_.standing_contacts_.empty())
    return clear ? 0 : qs.cols();
  for (Eigen::Index first = 0; first < qs.cols(); first += kLanes) {
    const Eigen::Index count = std::min<Eigen::Index>(kLanes, qs.cols() - first);
    const LaneAnswer answer =
        world_.lanes_.ask_grown(qs.middleCols(first, count), changes_.leftCols(0), clearances_,
                                clear ? LaneScope::Ahead : LaneScope::Each);
    for (Eigen::Index i = 0; i < count; ++i) {
      const bool is_near =
          (answer.surely >> i & 1U) != 0 ||
          ((answer.maybe >> i & 1U) != 0 && !is_clear(static_cast<int>(i), qs.col(first + i)));
      if (is_near == clear)
        return first + i;
    }
  }
  return qs.cols();
}

bool EdgeProver::is_clear(int lane, const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (!world_.lanes_.doubtful_pairs(lane, doubtful_))
    doubtful_ = pairs_;
  kinematics::joint_poses(world_.robot_.parts().chain, q, world_.T_base_joints_);
  return std::ranges::all_of(doubtful_, [&](const BodyPair& pair) {
    place(pair);
    return placed_distance_m(pair) > clearance_m(pair);
  });
}

void EdgeProver::place(const BodyPair& pair) {
  for (const std::size_t index : {pair.first, pair.second})
    if (const Body& body = world_.bodies_[index]; body.joint >= 0)
      world_.T_base_bodies_[index] =
          world_.T_base_joints_[static_cast<std::size_t>(body.joint)] * body.T_joint_body;
}

double EdgeProver::placed_distance_m(const BodyPair& pair) const {
  const Solid &a = world_.bodies_[pair.first].solid, &b = world_.bodies_[pair.second].solid;
  const Eigen::Isometry3d &T_a = world_.T_base_bodies_[pair.first],
                          &T_b = world_.T_base_bodies_[pair.second];
  const double clearance = clearance_m(pair), cheap_m = cheap_distance_m(a, T_a, b, T_b);
  return cheap_m > clearance ? cheap_m
                             : close_distance_m(a, T_a, b, T_b, clearance + kMotionRounding_m);
}

double EdgeProver::least_clearance_m(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  begin(qs, {.clearance_m = kLargestRoom_m});
  double& least_m = clearances_.standing_m;  // what is farther is not looked at
  for (Eigen::Index first = 0; first < qs.cols(); first += kLanes) {
    const Eigen::Index count = std::min<Eigen::Index>(kLanes, qs.cols() - first);
    const LaneAnswer answer = world_.lanes_.ask_grown(
        qs.middleCols(first, count), changes_.leftCols(0), clearances_, LaneScope::Each);
    for (int lane = 0; lane < static_cast<int>(count); ++lane) {
      if ((answer.maybe >> lane & 1U) == 0)
        continue;
      if ((answer.surely >> lane & 1U) != 0 || !world_.lanes_.doubtful_pairs(lane, doubtful_))
        doubtful_ = pairs_;
      kinematics::joint_poses(world_.robot_.parts().chain, qs.col(first + lane),
                              world_.T_base_joints_);
      for (const BodyPair& pair : doubtful_)
        if (!is_own(pair)) {
          place(pair);
          least_m = std::min(least_m, placed_distance_m(pair));
        }
    }
  }
  return least_m;
}

std::vector<NearPair> EdgeProver::find_near(const Eigen::Ref<const Eigen::VectorXd>& q,
                                            const EdgeProofOptions& options) {
  begin(q, options);
  world_.place(q);
  std::vector<NearPair> near;
  const auto add = [&](const BodyPair& pair, double distance_m) {
    const auto [first, second] = world_.names(pair);
    for (NearPair& known : near)
      if (known.first == first && known.second == second) {
        known.clearance_m = std::min(known.clearance_m, distance_m);
        return;
      }
    near.push_back({first, second, distance_m, clearance_m(pair)});
  };
  for (const BodyPair& pair : world_.standing_contacts_)
    add(pair, 0);
  for (const BodyPair& pair : world_.pairs_)
    if (const double distance_m = placed_distance_m(pair); distance_m <= clearance_m(pair))
      add(pair, distance_m);
  return near;
}

}  // namespace kinship::collision
