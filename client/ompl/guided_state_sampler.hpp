#pragma once

#include <ompl/base/StateSampler.h>

#include <cstdint>
#include <memory>
#include <random>

#include "robots/planning/configuration_sampler.hpp"

namespace kinship::ompl_planners {

/// Gives any planner of OMPL the samples of a ConfigurationSampler in place of uniform ones;
/// samples near a state are those of the space. One planner thread uses one instance.
///
/// RRT-like planners draw from the space's StateSampler, roadmap planners from a ValidStateSampler
/// that draws from it in turn, so the space is the one place to replace samples.
class GuidedStateSampler : public ompl::base::StateSampler {
 public:
  /// \param space    from make_state_space, with as many joints as the sampler has.
  /// \param sampler  shared by all instances that planners of the space allocate.
  GuidedStateSampler(const ompl::base::StateSpace* space,
                     std::shared_ptr<const planning::ConfigurationSampler> sampler,
                     std::uint64_t seed);

  void sampleUniform(ompl::base::State* state) override;
  void sampleUniformNear(ompl::base::State* state, const ompl::base::State* near,
                         double distance) override;
  void sampleGaussian(ompl::base::State* state, const ompl::base::State* mean,
                      double standard_deviation) override;

 private:
  std::shared_ptr<const planning::ConfigurationSampler> sampler_;
  std::mt19937_64 generator_;
  ompl::base::StateSamplerPtr space_sampler_;
};

/// Makes every planner of the space draw from the sampler; the n-th allocated sampler is seeded
/// with seed + n. Planners keep their samplers: install before their setup.
/// \param space  from make_state_space, or a ProjectedStateSpace over one: there the sampler is set
///               on the ambient space, and its samples are projected onto the constraint. (Set on
///               the projected space itself, OMPL 1.5 would silently ignore it.)
/// \throws std::invalid_argument if space and sampler differ in size, or for another space: an
///         AtlasStateSpace or TangentBundleStateSpace draws from its charts.
void install_guided_sampler(ompl::base::StateSpace& space,
                            std::shared_ptr<const planning::ConfigurationSampler> sampler,
                            std::uint64_t seed);

}  // namespace kinship::ompl_planners
