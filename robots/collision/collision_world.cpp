#include "robots/collision/collision_world.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {

namespace {

void require_finite(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  const auto is_finite = [](const auto& values) {  // else NaN
    return (values - values).sum() == 0;
  };
  const bool in_one_piece = qs.outerStride() == qs.rows();
  if (in_one_piece ? !is_finite(Eigen::Map<const Eigen::ArrayXd>(qs.data(), qs.size()))
                   : !is_finite(qs.array()))
    throw std::invalid_argument("CollisionWorld: q is not finite");
}

}  // namespace

CollisionWorld::CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings)
    : robot_(robot),
      bodies_(bodies_among(robot, surroundings)),
      T_base_bodies_(standing_poses(bodies_)),
      pairs_(moving_pairs(bodies_, robot.parts().checked, surroundings)),
      standing_pairs_(standing_pairs(bodies_, surroundings)),
      lanes_(robot.parts().chain, bodies_, pairs_) {
  for (const BodyPair& pair : standing_pairs_)
    if (touching(pair))
      standing_contacts_.push_back(pair);
}

CollisionWorld::CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                               const Surroundings& surroundings)
    : CollisionWorld(RobotSolids(chain, shapes), surroundings) {}

bool CollisionWorld::collides(const Eigen::Ref<const Eigen::VectorXd>& q) {
  return free_ahead(q) == 0;
}

Eigen::Index CollisionWorld::free_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  return alike_ahead(qs, false);
}

Eigen::Index CollisionWorld::colliding_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs) {
  return alike_ahead(qs, true);
}

Eigen::Index CollisionWorld::alike_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs,
                                         bool colliding) {
  if (qs.rows() != robot_.parts().chain.dof())
    throw std::invalid_argument("CollisionWorld: " + std::to_string(qs.rows()) + " values for " +
                                std::to_string(robot_.parts().chain.dof()) + " joints");
  require_finite(qs);
  for (Eigen::Index first = 0; first < qs.cols(); first += kLanes) {
    const Eigen::Index count = std::min<Eigen::Index>(kLanes, qs.cols() - first);
    const auto together = qs.middleCols(first, count);
    const LaneAnswer answer = lanes_.ask(together, colliding ? LaneScope::Each : LaneScope::Ahead);
    for (Eigen::Index i = 0; i < count; ++i) {
      ++checks_;
      const bool collides = !standing_contacts_.empty() || (answer.surely >> i & 1U) != 0 ||
                            ((answer.maybe >> i & 1U) != 0 &&
                             touches_in_doubt(static_cast<int>(i), qs.col(first + i)));
      if (collides != colliding)
        return first + i;
    }
  }
  return qs.cols();
}

bool CollisionWorld::touches_in_doubt(int lane, const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (!lanes_.doubtful_pairs(lane, doubtful_))
    return first_contact(q).has_value();
  kinematics::joint_poses(robot_.parts().chain, q, T_base_joints_);
  for (const auto& [a, b] : doubtful_) {
    for (const std::size_t i : {a, b})
      if (bodies_[i].joint >= 0)
        T_base_bodies_[i] =
            T_base_joints_[static_cast<std::size_t>(bodies_[i].joint)] * bodies_[i].T_joint_body;
    if (touching({a, b}))
      return true;
  }
  return false;
}

std::optional<std::pair<std::string, std::string>> CollisionWorld::find_contact(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  const auto pair = first_contact(q);
  if (!pair)
    return std::nullopt;
  return names(*pair);
}

std::set<std::pair<std::string, std::string>> CollisionWorld::find_contacts(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  place(q);
  std::set<std::pair<std::string, std::string>> found;
  for (const BodyPair& pair : standing_contacts_)
    found.insert(names(pair));
  for (const BodyPair& pair : pairs_)
    if (touching(pair))
      found.insert(names(pair));
  return found;
}

CollisionWorld::NearestPairs CollisionWorld::find_nearest(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  place(q);
  NearestPairs nearest;
  for (const BodyPair& pair : pairs_) {
    const auto [a, b] = pair;
    const bool is_own =
        bodies_[a].kind != BodyKind::Obstacle && bodies_[b].kind != BodyKind::Obstacle;
    std::optional<NearestPair>& known = is_own ? nearest.own : nearest.obstacle;
    const double enough_m = known ? known->distance_m : std::numeric_limits<double>::infinity();
    if (cheap_distance_m(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid,
                         T_base_bodies_[b]) >= enough_m)
      continue;
    const double distance_m = close_distance_m(bodies_[a].solid, T_base_bodies_[a],
                                               bodies_[b].solid, T_base_bodies_[b], enough_m);
    if (distance_m < enough_m)
      known = {bodies_[a].name, bodies_[b].name, distance_m};
  }
  return nearest;
}

std::vector<CollisionWorld::Enclosed> CollisionWorld::find_enclosed(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  place(q);
  std::vector<Enclosed> found;
  const auto look = [&](std::size_t inner, std::size_t mesh) {
    if (!bodies_[mesh].solid.is_hollow())
      return;
    const Enclosed names{bodies_[inner].name, bodies_[mesh].name};
    if (std::ranges::find(found, names) == found.end() &&
        encloses(bodies_[mesh].solid, T_base_bodies_[mesh], bodies_[inner].solid,
                 T_base_bodies_[inner]) &&
        !touching({inner, mesh}))
      found.push_back(names);
  };
  for (const std::vector<BodyPair>* const pairs : {&pairs_, &standing_pairs_})
    for (const auto& [a, b] : *pairs)
      if (bodies_[a].kind != BodyKind::Link || bodies_[b].kind != BodyKind::Link) {
        look(a, b);
        look(b, a);
      }
  return found;
}

void CollisionWorld::place(const Eigen::Ref<const Eigen::VectorXd>& q) {
  require_finite(q);
  place_bodies(robot_.parts().chain, bodies_, q, T_base_bodies_);
}

std::optional<BodyPair> CollisionWorld::first_contact(const Eigen::Ref<const Eigen::VectorXd>& q) {
  place(q);
  if (!standing_contacts_.empty())
    return standing_contacts_.front();
  for (const BodyPair& pair : pairs_)
    if (touching(pair))
      return pair;
  return std::nullopt;
}

bool CollisionWorld::touching(const BodyPair& pair) const {
  const auto [a, b] = pair;
  return touch(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid, T_base_bodies_[b]);
}

std::pair<std::string, std::string> CollisionWorld::names(const BodyPair& pair) const {
  return {bodies_[pair.first].name, bodies_[pair.second].name};
}

}  // namespace kinship::collision
