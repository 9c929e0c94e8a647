#pragma once

#include <cstdint>
#include <iosfwd>

#include "client/cli/distribution_query.hpp"
#include "client/link/client.hpp"

namespace kinship::cli {

struct FetchOptions {
  DistributionQuery query;
  std::uint64_t samples = 0;  ///< configurations to draw and print as CSV, instead of the rest
  std::uint64_t seed = 0;     ///< of these samples
  bool json = false;
};

/// `distributions fetch`: a robot's distribution for a task, made if need be.
/// \return kNotFound without experience, kFailed if it is still pending after `wait`.
int fetch_distribution(link::Client& server, const FetchOptions& options, std::ostream& out,
                       std::ostream& err);

/// A distribution for people: its sources and its mixture.
void print_distribution(const Distribution& distribution, std::ostream& out);

/// `distributions explain`: a distribution's sources, why it failed, its state against the present
/// experience, the best guide of its robot. Explains also a failed distribution.
int explain_distribution(link::Client& server, const DistributionQuery& query, bool json,
                         std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
