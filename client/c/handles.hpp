#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/c/kinship.h"
#include "client/link/client.hpp"
#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/distribution.hpp"

/// What the handles of kinship.h are; their names are C's.
// NOLINTBEGIN(readability-identifier-naming)
struct kinship_client {
  explicit kinship_client(const kinship::link::ClientOptions& options) : line(options) {}
  kinship::link::Client line;
};

struct kinship_distribution {
  std::shared_ptr<const kinship::Distribution> value;  // with a mixture; shared with the follower
};

struct kinship_follower {
  std::unique_ptr<kinship::link::Follower> value;
};

struct kinship_sampler {
  explicit kinship_sampler(const kinship::Distribution& distribution)
      : value(distribution), limits(distribution.limits) {}
  kinship::mixture::DistributionSampler value;
  Eigen::Matrix2Xd limits;
};
// NOLINTEND(readability-identifier-naming)

namespace kinship::c_library {

/// \param numbers  x y z qx qy qz qw. \param name  of the argument, for messages.
/// \throws Failure(InvalidInput) if they are no pose.
Eigen::Isometry3d read_pose(const double* numbers, const char* name);

/// \throws Failure(InvalidInput) if it is NULL.
Digest read_robot(const kinship_robot* robot, const char* name);

std::string text_or_empty(const char* text);

/// \param names  2 n, pair by pair. \throws Failure(InvalidInput) if one is NULL.
std::vector<std::pair<std::string, std::string>> read_pairs(const char* const* names,
                                                            std::size_t pairs, const char* name);

}  // namespace kinship::c_library
