#pragma once

#include "proto/types/conversations.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"

namespace kinship::rehearsal {

/// A `done` that first adds the known rehearsal of the request's robot and task to the reply, and
/// its library of paths to recall unless the client holds it, if the reply is Ready, Failed or
/// Pending. A request for a rehearsed reply waits for the rehearsal
/// until its deadline.
/// \param request  a request for experience.
/// \param rehearsals  outlive the reply.
catalog::FetchDone with_rehearsal(RehearsalScheduler& rehearsals, const FetchRequest& request,
                                  RehearsalScheduler::TimePoint now, catalog::FetchDone done);

}  // namespace kinship::rehearsal
