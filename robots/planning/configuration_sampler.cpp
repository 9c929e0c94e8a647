#include "robots/planning/configuration_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>

#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {
namespace {

constexpr int kMaxTurnDraws = 100;

/// In [0, 1), as std::uniform_real_distribution draws it, without a division.
double draw_unit(std::mt19937_64& generator) {
  static_assert(std::mt19937_64::max() == std::numeric_limits<std::uint64_t>::max());
  const double drawn = static_cast<double>(generator()) * 0x1p-64;
  return drawn < 1 ? drawn : std::nextafter(1.0, 0.0);
}

/// The bounds, but none for turning joints.
Eigen::Matrix2Xd draw_limits(const Eigen::Matrix2Xd& bounds, const std::vector<bool>& turning) {
  Eigen::Matrix2Xd limits = bounds;
  for (Eigen::Index i = 0; i < limits.cols(); ++i)
    if (turning[static_cast<std::size_t>(i)])
      limits.col(i) << -std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::infinity();
  return limits;
}

}  // namespace

ConfigurationSampler::ConfigurationSampler(Eigen::Matrix2Xd bounds) : bounds_(std::move(bounds)) {
  turning_.assign(static_cast<std::size_t>(bounds_.cols()), false);
  if (!bounds_.allFinite() || (bounds_.row(0).array() > bounds_.row(1).array()).any())
    throw std::invalid_argument("ConfigurationSampler: bounds are not finite or crossed");
}

ConfigurationSampler::ConfigurationSampler(Eigen::Matrix2Xd bounds, const kinematics::Chain& chain,
                                           const Mixture& mixture, double guided_fraction)
    : ConfigurationSampler(std::move(bounds)) {
  if (mixture.dimension() != bounds_.cols() || chain.dof() != bounds_.cols())
    throw std::invalid_argument("ConfigurationSampler: chain, mixture and bounds differ in size");
  if (!(guided_fraction >= 0 && guided_fraction <= 1))
    throw std::invalid_argument("ConfigurationSampler: share is not between 0 and 1");
  turning_ = turning_joints(chain);
  mixture_ = mixture;
  guided_.emplace(mixture, draw_limits(bounds_, turning_));
  mixture_fraction_ = guided_fraction;
}

ConfigurationSampler ConfigurationSampler::with_tracks(std::shared_ptr<QueryTracks> tracks,
                                                       double fraction) const {
  if (!(fraction >= 0 && fraction <= 1))
    throw std::invalid_argument("ConfigurationSampler: share is not between 0 and 1");
  ConfigurationSampler sampler = *this;
  sampler.tracks_ = std::move(tracks);
  sampler.track_fraction_ = fraction;
  sampler.mixture_fraction_ = std::min(mixture_fraction_, 1 - fraction);
  return sampler;
}

Eigen::VectorXd ConfigurationSampler::sample(std::mt19937_64& generator,
                                             double guided_fraction) const {
  Eigen::VectorXd q(bounds_.cols());
  draw(generator, guided_fraction, q);
  return q;
}

void ConfigurationSampler::draw(std::mt19937_64& generator, double guided_fraction,
                                Eigen::VectorXd& q) const {
  if (guided_ || tracks_) {
    const double drawn = draw_unit(generator);
    if (drawn < guided_fraction)
      if (auto guided = sample_guided(drawn, guided_fraction, generator)) {
        q = *std::move(guided);
        return;
      }
  }
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] = bounds_(0, i) + (bounds_(1, i) - bounds_(0, i)) * draw_unit(generator);
}

/// Tracks and mixture keep their proportion, whatever the share of both.
std::optional<Eigen::VectorXd> ConfigurationSampler::sample_guided(
    double drawn, double guided_fraction, std::mt19937_64& generator) const {
  const double around_tracks = guided_fraction * track_fraction_ / this->guided_fraction();
  return drawn < around_tracks ? tracks_->sample(generator) : sample_mixture(generator);
}

std::optional<Eigen::VectorXd> ConfigurationSampler::sample_mixture(
    std::mt19937_64& generator) const {
  for (int draw = 0; guided_ && draw < kMaxTurnDraws; ++draw) {
    const auto q = guided_->sample(generator);
    if (!q)
      return std::nullopt;  // the mixture lies outside the bounds
    if (auto turned = turned_into(bounds_, turning_, *q))
      return turned;
  }
  return std::nullopt;
}

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
