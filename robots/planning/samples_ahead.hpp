#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <random>

#include "robots/planning/configuration_sampler.hpp"
#include "robots/planning/nearest_nodes.hpp"

/// For this library's sources only.
namespace kinship::planning {

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
