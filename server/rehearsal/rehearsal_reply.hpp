#pragma once

#include "proto/types/conversations.hpp"
#include "server/catalog/pending_fit.hpp"
#include "server/rehearsal/rehearsal_scheduler.hpp"

namespace kinship::rehearsal {

/// `done`, called with what is known of the guides of the request's robot and task, beside whatever
/// else the reply has, unless that is refused, busy or of a robot that nobody knows. A request for
/// a rehearsed reply waits for it until its deadline.
/// \param request  one that asks for experience.
/// \param rehearsals  outlive the reply.
catalog::FetchDone with_rehearsal(RehearsalScheduler& rehearsals, const FetchRequest& request,
                                  RehearsalScheduler::TimePoint now, catalog::FetchDone done);

}  // namespace kinship::rehearsal
