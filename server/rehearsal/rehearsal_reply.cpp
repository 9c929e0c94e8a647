#include "server/rehearsal/rehearsal_reply.hpp"

#include <memory>
#include <utility>

#include "server/catalog/experience_reply.hpp"

namespace kinship::rehearsal {
namespace {

bool carries_rehearsal(FetchStatus status) {
  return status == FetchStatus::Ready || status == FetchStatus::Failed ||
         status == FetchStatus::Pending;
}

/// A reply with what is known for its robot where it stands.
class Addition {
 public:
  Addition(const RehearsalScheduler& rehearsals, RehearsalKey key, std::uint64_t known_recall)
      : rehearsals_(rehearsals), key_(std::move(key)), known_recall_(known_recall) {}

  const RehearsalKey& key() const { return key_; }

  void send(FetchReply reply, const SharedRehearsal& known, const catalog::FetchDone& done) const {
    if (known)
      reply.rehearsal = *known;
    const SharedLibrary library = rehearsals_.library(key_);
    const std::uint64_t revision = library ? library->revision : 0;
    if (library && revision != known_recall_ &&
        recall_bytes(*library) <= catalog::room_for_experience(reply))
      reply.recall = *library;
    else if (revision != known_recall_)
      take_back(reply);
    done(reply);
  }

  /// Tells a client that holds a library that it is no longer good.
  void take_back(FetchReply& reply) const {
    if (known_recall_ != 0)
      reply.recall.emplace().revision = 1;
  }

 private:
  const RehearsalScheduler& rehearsals_;
  const RehearsalKey key_;
  const std::uint64_t known_recall_;  // revision that the client holds
};

}  // namespace

catalog::FetchDone with_rehearsal(RehearsalScheduler& rehearsals, const FetchRequest& request,
                                  RehearsalScheduler::TimePoint now, catalog::FetchDone done) {
  const Result<fitting::DistributionKey> distribution =
      fitting::make_key(request, rehearsals.geometry_revision(request.robot));
  if (!distribution)
    return done;  // it will be refused
  const auto& start = request.start;
  const Addition addition(rehearsals,
                          {*distribution, request.experience_bytes,
                           Eigen::Map<const Eigen::VectorXd>(start.data(), std::ssize(start)),
                           request.T_task_goal, request.to_configuration},
                          request.known_recall);
  return [&rehearsals, addition, deadline = now + request.deadline, waits = request.rehearsed,
          done = std::move(done)](const FetchReply& reply) {
    if (reply.status == FetchStatus::NoExperience) {
      FetchReply none = reply;
      addition.take_back(none);
      return done(none);
    }
    if (!carries_rehearsal(reply.status))
      return done(reply);
    if (!waits)
      return addition.send(reply, rehearsals.ask(addition.key()), done);
    rehearsals.wait(
        addition.key(), deadline,
        [own = std::make_shared<FetchReply>(reply), addition, done](const SharedRehearsal& known) {
          addition.send(std::move(*own), known, done);
        });
  };
}

}  // namespace kinship::rehearsal
