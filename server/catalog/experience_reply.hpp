#pragma once

#include "proto/types/conversations.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/catalog/pending_fit.hpp"

namespace kinship::catalog {

/// `done` with the requested experience added to the reply, whatever its status, except Refused and
/// Busy. The reply waits for the experience, and stays unchanged if there is none. An experience
/// without paths tells a client that holds some that all are gone.
/// \param experience_index  outlives the reply; begins to choose at once.
FetchDone with_experience(ExperienceIndex& experience_index, const FetchRequest& request,
                          FetchDone done);

/// Bytes of a message left for an experience beside the rest of a reply: a distribution, a
/// rehearsal, which takes 3 KB at most, and a library of paths to recall.
std::size_t room_for_experience(const FetchReply& reply);

}  // namespace kinship::catalog
