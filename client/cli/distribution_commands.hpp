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

/// A distribution for people: where it is from, what is in it.
void print_distribution(const Distribution& distribution, std::ostream& out);

/// `distributions explain`: what a distribution is made of, why it failed, how it stands to the
/// experience of now, what guides its robot best. One that could not be made is explained too.
int explain_distribution(link::Client& server, const DistributionQuery& query, bool json,
                         std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
