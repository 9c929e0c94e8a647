#include "proto/dds/requester.hpp"

#include <mutex>
#include <optional>
#include <string>

#include "proto/dds/request_channel.hpp"
#include "proto/dds/role_topics.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds {

template <typename Conversation>
class Requester<Conversation>::Implementation {
 public:
  using Reply = typename Conversation::Reply;

  Implementation(const Participant& participant, const Uuid& client_id)
      : participant_(participant),
        client_id_(client_id),
        refusal_(explain_not_allowed(participant, Conversation::kName)) {}

  Result<Reply> call(const typename Conversation::Request& request, Clock::time_point deadline) {
    if (refusal_)
      return *refusal_;
    const Clock::time_point start = Clock::now();
    const Result<RequestChannel*> made = line();
    if (!made)
      return made.error();
    RequestChannel& line = **made;
    const codec::Head head = line.next_head();
    const auto message = codec::encode(head, request);
    if (!message)
      return message.error();
    std::optional<Result<Reply>> reply;
    const auto outcome = line.call(head, &message->wire, deadline, [&reply](const void* wire) {
      reply.emplace(codec::decode(*static_cast<const typename Wire<Conversation>::Reply*>(wire)));
    });
    if (outcome != RequestChannel::Outcome::Answered)
      return nobody_answered(start, line.has_server());
    if (!*reply)
      return Error{ErrorCode::Internal,
                   std::string("reply to ") + Conversation::kName + ": " + reply->error().message};
    return *std::move(reply);
  }

  std::uint64_t count_servers() {
    if (refusal_)
      return 0;
    const Result<RequestChannel*> made = line();
    return made ? (*made)->count_servers() : 0;
  }
  void cancel() {
    const std::lock_guard lock(mutex_);
    is_cancelled_ = true;
    if (line_)
      line_->cancel();
  }

 private:
  Result<RequestChannel*> line() try {
    const std::lock_guard lock(mutex_);
    if (!line_) {
      line_.emplace(participant_, client_id_, Wire<Conversation>::topics());
      if (is_cancelled_)
        line_->cancel();
    }
    return &*line_;
  } catch (const Failure& failure) {
    return failure.error();
  }

  Error nobody_answered(Clock::time_point start, bool has_server) const {
    const ParticipantOptions& options = participant_.options();
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start);
    return {ErrorCode::Unavailable,
            std::string(Conversation::kName) + ": " +
                (has_server ? "the server did not answer" : "no server answered") + " within " +
                std::to_string(waited.count()) + " ms (domain " + std::to_string(options.domain) +
                ", " + options.server +
                (options.security.empty() ? "" : ", security " + options.security.string()) + ")" +
                (has_server ? "" : note_of_environment())};
  }

  const Participant& participant_;
  const Uuid client_id_;
  const std::optional<Error> refusal_;  // of every request
  std::mutex mutex_;                    // guards what follows
  bool is_cancelled_ = false;
  std::optional<RequestChannel> line_;  // from the first use on
};

template <typename Conversation>
Requester<Conversation>::Requester(const Participant& participant, const Uuid& client_id)
    : implementation_(std::make_unique<Implementation>(participant, client_id)) {}

template <typename Conversation>
Requester<Conversation>::~Requester() = default;

template <typename Conversation>
Result<typename Conversation::Reply> Requester<Conversation>::call(
    const typename Conversation::Request& request, Clock::time_point deadline) {
  return implementation_->call(request, deadline);
}

template <typename Conversation>
std::uint64_t Requester<Conversation>::count_servers() {
  return implementation_->count_servers();
}

template <typename Conversation>
void Requester<Conversation>::cancel() {
  implementation_->cancel();
}

template class Requester<codec::RegisterConversation>;
template class Requester<codec::ReportConversation>;
template class Requester<codec::FetchConversation>;
template class Requester<codec::AdminConversation>;

}  // namespace kinship::dds
