#include "server/rehearsal/rehearsal_reply.hpp"

#include <memory>
#include <utility>

namespace kinship::rehearsal {
namespace {

bool carries_rehearsal(FetchStatus status) {
  return status == FetchStatus::Ready || status == FetchStatus::Failed ||
         status == FetchStatus::Pending;
}

void send(FetchReply reply, const SharedRehearsal& known, const catalog::FetchDone& done) {
  if (known)
    reply.rehearsal = *known;
  done(reply);
}

}  // namespace

catalog::FetchDone with_rehearsal(RehearsalScheduler& rehearsals, const FetchRequest& request,
                                  RehearsalScheduler::TimePoint now, catalog::FetchDone done) {
  const Result<fitting::DistributionKey> distribution =
      fitting::make_key(request, rehearsals.geometry_revision(request.robot));
  if (!distribution)
    return done;  // it will be refused
  return [&rehearsals, key = RehearsalKey{*distribution, request.experience_bytes},
          deadline = now + request.deadline, waits = request.rehearsed,
          done = std::move(done)](const FetchReply& reply) {
    if (!carries_rehearsal(reply.status))
      return done(reply);
    if (!waits)
      return send(reply, rehearsals.ask(key), done);
    rehearsals.wait(key, deadline,
                    [own = std::make_shared<FetchReply>(reply),
                     done](const SharedRehearsal& known) { send(std::move(*own), known, done); });
  };
}

}  // namespace kinship::rehearsal
