#pragma once

#include <optional>

#include "proto/types/digest.hpp"
#include "proto/types/failure.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

/// Registers a robot of one store at another one unless it is there. Where another robot has its
/// label it is registered with the beginning of its digest behind the label: a label is a name at
/// one site, the digest says which robot it is.
/// \return why it cannot be registered; nothing if it is there.
/// \throws Failure of either store.
std::optional<Error> carry_robot(const store::Store& from, store::Store& to, const Digest& robot);

}  // namespace kinship::sites
