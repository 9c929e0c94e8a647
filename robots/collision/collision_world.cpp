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
      if (!standing_contact_ && touching(pair))
        standing_contact_ = pair;
  }

  std::optional<BodyPair> first_contact(const Eigen::Ref<const Eigen::VectorXd>& q) {
    if (!q.allFinite())
      throw std::invalid_argument("CollisionWorld: q is not finite");
    if (standing_contact_)
      return standing_contact_;
    place_bodies(robot_.parts().chain, bodies_, q, T_base_bodies_);
    for (const BodyPair& pair : pairs_)
      if (touching(pair))
        return pair;
    return std::nullopt;
  }

  std::pair<std::string, std::string> names(const BodyPair& pair) const {
    return {bodies_[pair.first].name, bodies_[pair.second].name};
  }

  std::uint64_t checks = 0;

 private:
  bool touching(const BodyPair& pair) const {
    const auto [a, b] = pair;
    return touch(bodies_[a].solid, T_base_bodies_[a], bodies_[b].solid, T_base_bodies_[b]);
  }

  RobotSolids robot_;
  std::vector<Body> bodies_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;  // one per body; moving ones change per check
  std::vector<BodyPair> pairs_;
  std::optional<BodyPair> standing_contact_;  // makes every configuration collide
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

std::uint64_t CollisionWorld::checks() const noexcept { return implementation_->checks; }

}  // namespace kinship::collision
