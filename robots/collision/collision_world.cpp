#include "robots/collision/collision_world.hpp"

#include <stdexcept>

#include "robots/collision/robot_parts.hpp"

namespace kinship::collision {

class CollisionWorld::Implementation {
 public:
  Implementation(const RobotSolids& robot, const Surroundings& surroundings)
      : robot_(robot), bodies_(robot.parts().bodies) {
    add_surroundings(robot.parts().chain, surroundings, bodies_);
    pairs_ = moving_pairs(bodies_, robot.parts().unchecked, surroundings);
    T_base_bodies_ = standing_poses(bodies_);
    for (const BodyPair& pair : standing_pairs(bodies_, surroundings))
      if (touching(pair))
        standing_contacts_.push_back(pair);
  }

  std::optional<BodyPair> first_contact(const Eigen::Ref<const Eigen::VectorXd>& q) {
    require_finite(q);
    if (!standing_contacts_.empty())
      return standing_contacts_.front();
    place_bodies(robot_.parts().chain, bodies_, q, T_base_bodies_);
    for (const BodyPair& pair : pairs_)
      if (touching(pair))
        return pair;
    return std::nullopt;
  }

  std::vector<BodyPair> contacts(const Eigen::Ref<const Eigen::VectorXd>& q) {
    require_finite(q);
    std::vector<BodyPair> found = standing_contacts_;
    place_bodies(robot_.parts().chain, bodies_, q, T_base_bodies_);
    for (const BodyPair& pair : pairs_)
      if (touching(pair))
        found.push_back(pair);
    return found;
  }

  std::pair<std::string, std::string> names(const BodyPair& pair) const {
    return {bodies_[pair.first].name, bodies_[pair.second].name};
  }

  std::uint64_t checks = 0;

 private:
  static void require_finite(const Eigen::Ref<const Eigen::VectorXd>& q) {
    if (!q.allFinite())
      throw std::invalid_argument("CollisionWorld: q is not finite");
  }
  bool touching(const BodyPair& pair) const {
    const auto [a, b] = pair;
    return touch(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid, T_base_bodies_[b]);
  }

  RobotSolids robot_;
  std::vector<Body> bodies_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;  // one per body; moving ones change per check
  std::vector<BodyPair> pairs_;
  std::vector<BodyPair> standing_contacts_;  // each makes every configuration collide
};

CollisionWorld::CollisionWorld(const RobotSolids& robot, const Surroundings& surroundings)
    : implementation_(std::make_unique<Implementation>(robot, surroundings)) {}

CollisionWorld::CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                               const Surroundings& surroundings)
    : CollisionWorld(RobotSolids(chain, shapes), surroundings) {}

CollisionWorld::CollisionWorld(CollisionWorld&&) noexcept = default;
CollisionWorld& CollisionWorld::operator=(CollisionWorld&&) noexcept = default;
CollisionWorld::~CollisionWorld() = default;

bool CollisionWorld::collides(const Eigen::Ref<const Eigen::VectorXd>& q) {
  ++implementation_->checks;
  return implementation_->first_contact(q).has_value();
}

std::optional<std::pair<std::string, std::string>> CollisionWorld::find_contact(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  const auto pair = implementation_->first_contact(q);
  if (!pair)
    return std::nullopt;
  return implementation_->names(*pair);
}

std::set<std::pair<std::string, std::string>> CollisionWorld::find_contacts(
    const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::set<std::pair<std::string, std::string>> names;
  for (const BodyPair& pair : implementation_->contacts(q))
    names.insert(implementation_->names(pair));
  return names;
}

std::uint64_t CollisionWorld::checks() const noexcept { return implementation_->checks; }

}  // namespace kinship::collision
