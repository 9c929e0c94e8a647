#include "robots/planning/samples_ahead.hpp"

#include <algorithm>

namespace kinship::planning {

SamplesAhead::SamplesAhead(const ConfigurationSampler& sampler, std::mt19937_64& generator)
    : sampler_(sampler), generator_(generator), before_{generator, generator} {
  const Eigen::Index dof = sampler.bounds().cols();
  for (Sample& sample : samples_) {
    sample.q.resize(dof);
    for (Beginning& beginning : sample.beginnings) {
      beginning.target.resize(dof);
      beginning.first.resize(dof);
    }
  }
}

SamplesAhead::Sample& SamplesAhead::at(std::uint64_t skipped) {
  const std::uint64_t wanted = used_ + skipped;
  while (drawn_ <= wanted) {
    before_[(drawn_ - first_) / kAhead % before_.size()] = generator_;
    for (const std::uint64_t end = drawn_ + kAhead; drawn_ < end; ++drawn_) {
      Sample& sample = samples_[(drawn_ - first_) % samples_.size()];
      draw(drawn_, sample.q);
      sample.nearest = {};
      for (Beginning& beginning : sample.beginnings)
        beginning.near = -1;
    }
  }
  return samples_[(wanted - first_) % samples_.size()];
}

void SamplesAhead::give_back() {
  if (drawn_ > used_) {
    const std::uint64_t block = (used_ - first_) / kAhead;
    generator_ = before_[block % before_.size()];
    Eigen::VectorXd again(sampler_.bounds().cols());
    for (std::uint64_t ordinal = first_ + block * kAhead; ordinal < used_; ++ordinal)
      draw(ordinal, again);
  }
  first_ = drawn_ = used_;
}

void SamplesAhead::draw(std::uint64_t ordinal, Eigen::VectorXd& q) {
  sampler_.draw(generator_, guided_fraction(ordinal), q);
}

/// A query that the mixture has not solved soon may need configurations that it does not cover, and
/// without any uniform samples no patience would find them.
double SamplesAhead::guided_fraction(std::uint64_t ordinal) const {
  constexpr std::uint64_t kPatience = 300;  // samples
  constexpr double kLateFraction = 0.9;
  return ordinal < kPatience ? sampler_.guided_fraction()
                             : std::min(sampler_.guided_fraction(), kLateFraction);
}

}  // namespace kinship::planning
