#include "robots/collision/collision_world.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <stdexcept>

#include "robots/collision/body_pairs.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::collision {
namespace {

constexpr int kTouchSamples = 200;
constexpr int kAlwaysTouching = 190;  // of kTouchSamples
constexpr std::uint64_t kTouchSeed = 1;

}  // namespace

class CollisionWorld::Implementation {
 public:
  Implementation(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                 const Surroundings& surroundings)
      : chain_(chain),
        bodies_(make_bodies(chain, shapes, surroundings)),
        pairs_(moving_pairs(bodies_, chain, shapes, surroundings)) {
    for (const Body& body : bodies_)
      T_base_bodies_.push_back(body.T_joint_body);
    if (shapes.never_colliding.empty())
      drop_always_touching();
    for (const BodyPair& pair : standing_pairs(bodies_, surroundings))
      if (!standing_contact_ && touching(pair))
        standing_contact_ = pair;
  }

  std::optional<BodyPair> first_contact(const Eigen::Ref<const Eigen::VectorXd>& q) {
    if (!q.allFinite())
      throw std::invalid_argument("CollisionWorld: q is not finite");
    if (standing_contact_)
      return standing_contact_;
    place_bodies(q);
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

  void place_bodies(const Eigen::Ref<const Eigen::VectorXd>& q) {
    const std::vector<Eigen::Isometry3d> T_base_joints = kinematics::joint_poses(chain_, q);
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (bodies_[i].joint >= 0)
        T_base_bodies_[i] =
            T_base_joints[static_cast<std::size_t>(bodies_[i].joint)] * bodies_[i].T_joint_body;
  }

  bool both_links(const BodyPair& pair) const {
    return bodies_[pair.first].kind == BodyKind::Link &&
           bodies_[pair.second].kind == BodyKind::Link;
  }

  std::pair<int, int> link_pair(const BodyPair& pair) const {
    return std::minmax(bodies_[pair.first].link, bodies_[pair.second].link);
  }

  void drop_always_touching() {
    std::mt19937_64 generator(kTouchSeed);
    std::map<std::pair<int, int>, int> touches;  // by links: a pair counts once per configuration
    for (int sample = 0; sample < kTouchSamples; ++sample) {
      Eigen::VectorXd q(chain_.dof());
      for (Eigen::Index i = 0; i < q.size(); ++i)
        q[i] =
            std::uniform_real_distribution<double>(chain_.lower()[i], chain_.upper()[i])(generator);
      place_bodies(q);
      std::set<std::pair<int, int>> touched;
      for (const BodyPair& pair : pairs_)
        if (both_links(pair) && touching(pair))
          touched.insert(link_pair(pair));
      for (const auto& links : touched)
        ++touches[links];
    }
    std::erase_if(pairs_, [&](const BodyPair& pair) {
      return both_links(pair) && touches[link_pair(pair)] >= kAlwaysTouching;
    });
  }

  kinematics::Chain chain_;
  std::vector<Body> bodies_;
  std::vector<Eigen::Isometry3d> T_base_bodies_;  // one per body; moving ones change per check
  std::vector<BodyPair> pairs_;
  std::optional<BodyPair> standing_contact_;  // makes every configuration collide
};

CollisionWorld::CollisionWorld(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                               const Surroundings& surroundings)
    : implementation_(std::make_unique<Implementation>(chain, shapes, surroundings)) {}

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
