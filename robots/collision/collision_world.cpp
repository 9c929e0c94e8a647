#include "robots/collision/collision_world.hpp"

#include <stdexcept>

namespace kinship::collision {

CollisionWorld::CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings)
    : robot_(robot), bodies_(robot.parts().bodies) {
  add_surroundings(robot.parts().chain, surroundings, bodies_);
  pairs_ = moving_pairs(bodies_, robot.parts().unchecked, surroundings);
  T_base_bodies_ = standing_poses(bodies_);
  for (const BodyPair& pair : standing_pairs(bodies_, surroundings))
    if (touching(pair))
      standing_contacts_.push_back(pair);
}

CollisionWorld::CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                               const Surroundings& surroundings)
    : CollisionWorld(RobotSolids(chain, shapes), surroundings) {}

bool CollisionWorld::collides(const Eigen::Ref<const Eigen::VectorXd>& q) {
  ++checks_;
  return first_contact(q).has_value();
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

void CollisionWorld::place(const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (!q.allFinite())
    throw std::invalid_argument("CollisionWorld: q is not finite");
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
