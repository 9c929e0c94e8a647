#include "client/ompl/guided_state_sampler.hpp"

#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/constraint/ProjectedStateSpace.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>

#include "client/ompl/state_space.hpp"

namespace kinship::ompl_planners {
namespace {

namespace ob = ompl::base;

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw std::invalid_argument("install_guided_sampler: space '" + name + "' " + what);
}

/// The space that planners of `space` have their samples from.
ob::RealVectorStateSpace& sampled_space(ob::StateSpace& space) {
  ob::StateSpace* sampled = &space;
  if (const auto* constrained = dynamic_cast<const ob::ConstrainedStateSpace*>(&space)) {
    if (!dynamic_cast<const ob::ProjectedStateSpace*>(constrained))
      // A wrapper has the name of its wrapped space, hidden from StateSpace.
      refuse(constrained->getName(),
             "draws from its charts and would ignore a guided sampler; use a ProjectedStateSpace "
             "over the same ambient space and constraint");
    // A projected space wraps the sampler of its ambient space and never looks at an allocator
    // that was set on itself.
    sampled = constrained->getSpace().get();
  }
  auto* real = dynamic_cast<ob::RealVectorStateSpace*>(sampled);
  if (!real)
    refuse(sampled->getName(), "is none of make_state_space, nor a ProjectedStateSpace over one");
  return *real;
}

}  // namespace

GuidedStateSampler::GuidedStateSampler(
    const ompl::base::StateSpace* space,
    std::shared_ptr<const planning::ConfigurationSampler> sampler, std::uint64_t seed)
    : ompl::base::StateSampler(space),
      sampler_(std::move(sampler)),
      generator_(seed),
      space_sampler_(space->allocDefaultStateSampler()) {}

void GuidedStateSampler::sampleUniform(ompl::base::State* state) {
  copy_to_state(sampler_->sample(generator_), *state);
  space_->enforceBounds(state);
}

void GuidedStateSampler::sampleUniformNear(ompl::base::State* state, const ompl::base::State* near,
                                           double distance) {
  space_sampler_->sampleUniformNear(state, near, distance);
}

void GuidedStateSampler::sampleGaussian(ompl::base::State* state, const ompl::base::State* mean,
                                        double standard_deviation) {
  space_sampler_->sampleGaussian(state, mean, standard_deviation);
}

void install_guided_sampler(ompl::base::StateSpace& space,
                            std::shared_ptr<const planning::ConfigurationSampler> sampler,
                            std::uint64_t seed) {
  ob::RealVectorStateSpace& sampled = sampled_space(space);
  if (static_cast<Eigen::Index>(sampled.getDimension()) != sampler->bounds().cols())
    refuse(sampled.getName(), "has " + std::to_string(sampled.getDimension()) +
                                  " joints, the sampler " +
                                  std::to_string(sampler->bounds().cols()));
  // Copies of the allocator, which OMPL makes, share the counter: planners may use threads.
  auto next_seed = std::make_shared<std::atomic<std::uint64_t>>(seed);
  sampled.setStateSamplerAllocator([sampler = std::move(sampler), next_seed = std::move(next_seed)](
                                       const ob::StateSpace* asking) {
    return std::make_shared<GuidedStateSampler>(asking, sampler, (*next_seed)++);
  });
}

}  // namespace kinship::ompl_planners
