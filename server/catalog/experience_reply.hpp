#pragma once

#include "proto/types/conversations.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/catalog/pending_fit.hpp"

namespace kinship::catalog {

/// `done`, called with the experience that the request asks for beside whatever became of its
/// distribution, unless that is refused or busy. The reply waits for it, and is what it would have
/// been if there is none. One without paths tells who holds some that all are gone.
/// \param experience_index  outlives the reply; begins to choose at once.
FetchDone with_experience(ExperienceIndex& experience_index, const FetchRequest& request,
                          FetchDone done);

/// What a message has left for an experience beside the rest of a reply, bytes: a distribution, and
/// a rehearsal, which takes 2.5 KB at most.
std::size_t room_for_experience(const FetchReply& reply);

}  // namespace kinship::catalog
