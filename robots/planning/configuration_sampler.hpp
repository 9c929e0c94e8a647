#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "proto/mixture/sampler.hpp"
#include "proto/types/mixture.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/nearest_nodes.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {

/// The source of a planner's samples: a share from a mixture, a share around the tracks of the
/// query, the rest uniform within bounds. Immutable except for tracks, which are made when needed:
/// may be shared, between threads only without tracks.
class ConfigurationSampler {
 public:
  /// Uniform.
  /// \param bounds  2 x dof: lower, upper, joint units (see planning_bounds).
  /// \throws std::invalid_argument if a bound is not finite or a lower one exceeds its upper.
  explicit ConfigurationSampler(Eigen::Matrix2Xd bounds);

  /// Guided samples follow the mixture truncated to the bounds. Joints wider than a turn are drawn
  /// without limits and then moved by full turns into the bounds; the draw is repeated if no turn
  /// lies there. If all draws fail, the sample is uniform.
  /// \param chain  defines the joints that may be moved by full turns.
  /// \param guided_fraction  of the samples, 0 to 1.
  /// \throws std::invalid_argument also if dimensions differ or the share is not 0 to 1.
  /// \throws Failure(Internal) if a covariance is not positive definite.
  ConfigurationSampler(Eigen::Matrix2Xd bounds, const kinematics::Chain& chain,
                       const Mixture& mixture, double guided_fraction);

  /// The same with additional samples around tracks.
  /// \param tracks    not null.
  /// \param fraction  of all samples, 0 to 1; the mixture's share is reduced to at most the rest.
  /// \throws std::invalid_argument if the fraction is not 0 to 1.
  ConfigurationSampler with_tracks(std::shared_ptr<QueryTracks> tracks, double fraction) const;

  Eigen::VectorXd sample(std::mt19937_64& generator) const {
    return sample(generator, guided_fraction());
  }
  /// The same with another share of guided samples; a uniform sampler has none.
  Eigen::VectorXd sample(std::mt19937_64& generator, double guided_fraction) const;
  /// The same into an existing vector. \param q  dof.
  void draw(std::mt19937_64& generator, double guided_fraction, Eigen::VectorXd& q) const;

  const Eigen::Matrix2Xd& bounds() const noexcept { return bounds_; }
  /// Share of all samples; 0 if uniform.
  double guided_fraction() const noexcept { return mixture_fraction_ + track_fraction_; }
  /// Tracks to follow before samples are drawn, made at first use; null: none.
  QueryTracks* tracks() const noexcept { return tracks_.get(); }
  /// The mixture of the guided samples; none if all come from tracks or are uniform.
  const std::optional<Mixture>& mixture() const noexcept { return mixture_; }
  /// The same posture within the bounds; empty if no turn lies there.
  std::optional<Eigen::VectorXd> moved_into_bounds(const Eigen::VectorXd& q) const {
    return turned_into(bounds_, turning_, q);
  }

 private:
  std::optional<Eigen::VectorXd> sample_mixture(std::mt19937_64& generator) const;
  std::optional<Eigen::VectorXd> sample_guided(double drawn, double guided_fraction,
                                               std::mt19937_64& generator) const;

  Eigen::Matrix2Xd bounds_;
  std::optional<Mixture> mixture_;
  std::optional<mixture::Sampler> guided_;
  std::vector<bool> turning_;
  double mixture_fraction_ = 0;
  std::shared_ptr<QueryTracks> tracks_;
  double track_fraction_ = 0;
};

/// The samples of one search, drawn ahead of their use, with their nearest nodes and extensions.
/// Each sample equals the one that a draw at its use would give; after give_back() so does the
/// generator's state.
class SamplesAhead {
 public:
  static constexpr std::uint64_t kAhead = 8;

  /// The beginning of a tree's extension towards a sample; valid as long as no node is nearer.
  struct Beginning {
    Eigen::Index near = -1;   ///< its node; -1: not known
    Eigen::VectorXd target;   ///< of the extension
    Eigen::VectorXd first;    ///< its first configuration
    bool is_any = false;      ///< whether there is one
    std::uint64_t spent = 0;  ///< to find it, besides checks
  };

  struct Sample {
    Eigen::VectorXd q;
    std::array<NearestNode, 2> nearest;   ///< in either tree
    std::array<Beginning, 2> beginnings;  ///< of either tree's extension
  };

  /// Both must outlive this.
  SamplesAhead(const ConfigurationSampler& sampler, std::mt19937_64& generator);

  /// \param skipped  number of unused samples before it, below kAhead.
  Sample& at(std::uint64_t skipped);

  /// \param count  number of unused samples to mark as used, in order; at() returned each before.
  void use(std::uint64_t count) { used_ += count; }

  /// Drops unused samples. To be called before another user takes the generator, or the sampler
  /// changes.
  void give_back();

  std::uint64_t used() const noexcept { return used_; }

 private:
  void draw(std::uint64_t ordinal, Eigen::VectorXd& q);
  double guided_fraction(std::uint64_t ordinal) const;

  const ConfigurationSampler& sampler_;
  std::mt19937_64& generator_;
  std::array<std::mt19937_64, 2> before_;  // the generator before each of the last blocks of kAhead
  std::array<Sample, 2 * kAhead> samples_;
  std::uint64_t used_ = 0, drawn_ = 0;
  std::uint64_t first_ = 0;  // of the first block since something was given back
};

}  // namespace kinship::planning
