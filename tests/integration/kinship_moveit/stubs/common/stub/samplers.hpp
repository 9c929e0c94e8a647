#pragma once

#include "stub/core.hpp"

/// Constraint samplers of every release; `project` is Humble's alone.
namespace constraint_samplers {

class ConstraintSampler {
 public:
  ConstraintSampler(const planning_scene::PlanningSceneConstPtr& scene, const std::string& group)
      : scene_(scene), jmg_(scene->getRobotModel()->getJointModelGroup(group)) {}
  virtual ~ConstraintSampler() = default;
  virtual bool configure(const moveit_msgs::msg::Constraints& constraints) = 0;
  bool sample(moveit::core::RobotState& state, const moveit::core::RobotState& reference) {
    return sample(state, reference, 2);
  }
  virtual bool sample(moveit::core::RobotState& state, const moveit::core::RobotState& reference,
                      unsigned int attempts) = 0;
#ifdef KINSHIP_STUB_HUMBLE
  virtual bool project(moveit::core::RobotState& state, unsigned int attempts) = 0;
#endif
  virtual const std::string& getName() const = 0;
  void setGroupStateValidityCallback(const moveit::core::GroupStateValidityCallbackFn& callback) {
    group_state_validity_callback_ = callback;
  }

 protected:
  virtual void clear() { is_valid_ = false; }

  bool is_valid_ = false;
  planning_scene::PlanningSceneConstPtr scene_;
  const moveit::core::JointModelGroup* const jmg_;
  moveit::core::GroupStateValidityCallbackFn group_state_validity_callback_;
};
using ConstraintSamplerPtr = std::shared_ptr<ConstraintSampler>;

class ConstraintSamplerAllocator {
 public:
  virtual ~ConstraintSamplerAllocator() = default;
  virtual ConstraintSamplerPtr alloc(const planning_scene::PlanningSceneConstPtr& scene,
                                     const std::string& group,
                                     const moveit_msgs::msg::Constraints& constraints) = 0;
  virtual bool canService(const planning_scene::PlanningSceneConstPtr& scene,
                          const std::string& group,
                          const moveit_msgs::msg::Constraints& constraints) const = 0;
};

/// Inverse kinematics that takes the seed as its answer: tests look where it began.
class SeedKeeper : public ConstraintSampler {
 public:
  using ConstraintSampler::ConstraintSampler;
  bool configure(const moveit_msgs::msg::Constraints&) override { return true; }
#ifdef KINSHIP_STUB_HUMBLE
  bool sample(moveit::core::RobotState& state, const moveit::core::RobotState&,
              unsigned int) override {
    state.setToRandomPositions(jmg_);  // as Humble's, which is seeded by project() alone
    return true;
  }
  bool project(moveit::core::RobotState&, unsigned int) override { return true; }
#else
  bool sample(moveit::core::RobotState&, const moveit::core::RobotState&, unsigned int) override {
    return true;
  }
#endif
  const std::string& getName() const override {
    static const std::string kName = "SeedKeeper";
    return kName;
  }
};

class ConstraintSamplerManager {
 public:
  static ConstraintSamplerPtr selectDefaultSampler(
      const planning_scene::PlanningSceneConstPtr& scene, const std::string& group,
      const moveit_msgs::msg::Constraints&) {
    return std::make_shared<SeedKeeper>(scene, group);
  }
};

}  // namespace constraint_samplers
