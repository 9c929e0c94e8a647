#pragma once

#include <iosfwd>

#include "client/cli/distribution_wish.hpp"
#include "client/link/client.hpp"

namespace kinship::cli {

/// `distributions explain`: what a distribution is made of, why it failed, how it stands to the
/// experience of now. One that could not be made is explained too.
int explain_distribution(link::Client& server, const DistributionWish& wish, bool json,
                         std::ostream& out, std::ostream& err);

}  // namespace kinship::cli
