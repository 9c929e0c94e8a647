#include "client/planning/guided_state_sampler.hpp"

#include <ompl/base/StateSpace.h>

#include <atomic>
#include <stdexcept>
#include <utility>

#include "client/planning/state_space.hpp"

namespace kinship::planning {

GuidedStateSampler::GuidedStateSampler(const ompl::base::StateSpace* space,
                                       std::shared_ptr<const ConfigurationSampler> sampler,
                                       std::uint64_t seed)
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
                            std::shared_ptr<const ConfigurationSampler> sampler,
                            std::uint64_t seed) {
  if (static_cast<Eigen::Index>(space.getDimension()) != sampler->bounds().cols())
    throw std::invalid_argument("install_guided_sampler: space and sampler differ in size");
  // Copies of the allocator, which OMPL makes, share the counter: planners may use threads.
  auto next_seed = std::make_shared<std::atomic<std::uint64_t>>(seed);
  space.setStateSamplerAllocator([sampler = std::move(sampler), next_seed = std::move(next_seed)](
                                     const ompl::base::StateSpace* asking) {
    return std::make_shared<GuidedStateSampler>(asking, sampler, (*next_seed)++);
  });
}

}  // namespace kinship::planning
