#include <algorithm>
#include <atomic>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <pluginlib/class_list_macros.hpp>

#include "query.hpp"

namespace kinship_moveit {
namespace {

namespace samplers = constraint_samplers;
using moveit_msgs::msg::Constraints;

/// A seed for each sampler that is made.
std::uint64_t next_seed() {
  static std::atomic<std::uint64_t> seed = std::random_device{}();
  return ++seed;
}

/// Draws states of a group: a share of them from the distribution of the query, the others
/// uniform. Joint constraints are met by drawing again within them, poses by inverse kinematics
/// that begins at the draw. Used by one thread, as all samplers of MoveIt.
class GuidedSampler : public samplers::ConstraintSampler {
 public:
  GuidedSampler(const planning_scene::PlanningSceneConstPtr& scene, const std::string& group,
                std::shared_ptr<const Query> query)
      : ConstraintSampler(scene, group), query_(std::move(query)), generator_(next_seed()) {}

  bool configure(const Constraints& constraints) override {
    clear();
    is_valid_ = jmg_ != nullptr && jmg_->getVariableCount() == query_->arm->dof();
    within_.clear();
    inner_ = nullptr;
    if (!is_valid_)
      return false;
    if (!constraints.position_constraints.empty() || !constraints.orientation_constraints.empty()) {
      inner_ = samplers::ConstraintSamplerManager::selectDefaultSampler(scene_, jmg_->getName(),
                                                                        constraints);
      return is_valid_ = inner_ != nullptr;
    }
    for (const auto& joint : constraints.joint_constraints)
      is_valid_ = is_valid_ && add(joint);
    return is_valid_;
  }

  bool sample(moveit::core::RobotState& state, const moveit::core::RobotState& reference,
              unsigned int attempts) override {
    if (!is_valid_)
      return false;
    for (unsigned int i = 0; i < std::max(1U, attempts); ++i) {
      state = reference;
      std::vector<double> q = draw(state);
      for (const auto& [variable, range] : within_)
        if (q[variable] < range.first || q[variable] > range.second)
          q[variable] =
              std::uniform_real_distribution<double>(range.first, range.second)(generator_);
      state.setJointGroupPositions(jmg_, q.data());
      state.update();
      if (inner_ != nullptr) {
        inner_->setGroupStateValidityCallback(group_state_validity_callback_);
        if (sample_near(*inner_, state, reference, 1))
          return true;
      } else if (state.satisfiesBounds(jmg_)) {
        return true;
      }
    }
    return false;
  }

  /// Of Humble's interface alone.
  bool project(moveit::core::RobotState& state, unsigned int attempts) KINSHIP_HUMBLE_OVERRIDE {
    if (inner_ != nullptr) {
      inner_->setGroupStateValidityCallback(group_state_validity_callback_);
      const moveit::core::RobotState reference = state;
      return sample_near(*inner_, state, reference, attempts);
    }
    return sample(state, state, attempts);
  }

  const std::string& getName() const override {
    static const std::string kName = "KinshipGuidedSampler";
    return kName;
  }

 private:
  /// \return false if nothing is left of a variable's range.
  bool add(const moveit_msgs::msg::JointConstraint& joint) {
    const auto& names = jmg_->getVariableNames();
    const auto named = std::find(names.begin(), names.end(), joint.joint_name);
    if (named == names.end())
      return true;  // of another group
    const auto variable = static_cast<std::size_t>(named - names.begin());
    const auto& bounds = scene_->getRobotModel()->getVariableBounds(joint.joint_name);
    auto [known, is_new] = within_.try_emplace(
        variable, bounds.position_bounded_ ? bounds.min_position_ : -3.14159265358979,
        bounds.position_bounded_ ? bounds.max_position_ : 3.14159265358979);
    known->second.first = std::max(known->second.first, joint.position - joint.tolerance_below);
    known->second.second = std::min(known->second.second, joint.position + joint.tolerance_above);
    return known->second.first <= known->second.second;
  }

  std::vector<double> draw(moveit::core::RobotState& state) {
    constexpr std::size_t kTogether = 64;
    const std::size_t dof = query_->arm->dof();
    std::vector<double> q(dof);
    if (std::uniform_real_distribution<double>(0, 1)(generator_) >= query_->share) {
      state.setToRandomPositions(jmg_);
      state.copyJointGroupPositions(jmg_, q.data());
      return q;
    }
    if (drawn_.empty()) {
      drawn_.resize(kTogether * dof);
      if (kinship_sampler_fill(query_->guidance.sampler.get(), drawn_.data(), kTogether, dof,
                               KINSHIP_ROWS, generator_()) != KINSHIP_OK) {
        drawn_.clear();
        state.setToRandomPositions(jmg_);
        state.copyJointGroupPositions(jmg_, q.data());
        return q;
      }
    }
    std::copy_n(drawn_.end() - static_cast<std::ptrdiff_t>(dof), dof, q.begin());
    drawn_.resize(drawn_.size() - dof);
    return q;
  }

  const std::shared_ptr<const Query> query_;
  std::mt19937_64 generator_;
  std::vector<double> drawn_;                                // dof numbers each, taken from the end
  std::map<std::size_t, std::pair<double, double>> within_;  // of the group's variables
  samplers::ConstraintSamplerPtr inner_;                     // null: no pose is prescribed
};

}  // namespace

/// Gives MoveIt's planners guided samplers of the group whose query runs. The rest is left to
/// MoveIt's own samplers: no guidance, a control query, visibility constraints.
class SamplerAllocator : public samplers::ConstraintSamplerAllocator {
 public:
  samplers::ConstraintSamplerPtr alloc(const planning_scene::PlanningSceneConstPtr& scene,
                                       const std::string& group,
                                       const Constraints& constraints) override {
    const auto query = query_of(group, constraints);
    if (query == nullptr)
      return nullptr;
    auto sampler = std::make_shared<GuidedSampler>(scene, group, query);
    if (!sampler->configure(constraints))
      return nullptr;
    return sampler;
  }

  bool canService(const planning_scene::PlanningSceneConstPtr& scene, const std::string& group,
                  const Constraints& constraints) const override {
    const auto query = query_of(group, constraints);
    return query != nullptr && GuidedSampler(scene, group, query).configure(constraints);
  }

 private:
  static std::shared_ptr<const Query> query_of(const std::string& group,
                                               const Constraints& constraints) {
    const auto session = Session::current();
    const auto query = session != nullptr ? session->latest(group) : nullptr;
    const bool guides = query != nullptr && query->sampling == KINSHIP_GUIDED &&
                        query->guidance.sampler != nullptr && query->share > 0;
    return guides && constraints.visibility_constraints.empty() ? query : nullptr;
  }
};

}  // namespace kinship_moveit

PLUGINLIB_EXPORT_CLASS(kinship_moveit::SamplerAllocator,
                       constraint_samplers::ConstraintSamplerAllocator)
