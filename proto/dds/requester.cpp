#include "proto/dds/requester.hpp"

#include <optional>
#include <string>

#include "proto/dds/request_channel.hpp"
#include "proto/dds/role_topics.hpp"

namespace kinship::dds {

template <typename Conversation>
class Requester<Conversation>::Implementation {
 public:
  using Reply = typename Conversation::Reply;

  Implementation(const Participant& participant, const Uuid& client_id)
      : options_(participant.options()),
        refusal_(explain_not_allowed(participant, Conversation::kName)) {
    if (!refusal_)
      line_.emplace(participant, client_id, Wire<Conversation>::topics());
  }

  Result<Reply> call(const typename Conversation::Request& request, Clock::time_point deadline) {
    if (refusal_)
      return *refusal_;
    const Clock::time_point start = Clock::now();
    const codec::Head head = line_->next_head();
    const auto message = codec::encode(head, request);
    if (!message)
      return message.error();
    std::optional<Result<Reply>> reply;
    const auto outcome = line_->call(head, &message->wire, deadline, [&reply](const void* wire) {
      reply.emplace(codec::decode(*static_cast<const typename Wire<Conversation>::Reply*>(wire)));
    });
    if (outcome != RequestChannel::Outcome::Answered)
      return nobody_answered(start);
    if (!*reply)
      return Error{ErrorCode::Internal,
                   std::string("reply to ") + Conversation::kName + ": " + reply->error().message};
    return *std::move(reply);
  }

  std::uint64_t count_servers() { return line_ ? line_->count_servers() : 0; }
  void cancel() {
    if (line_)
      line_->cancel();
  }

 private:
  Error nobody_answered(Clock::time_point start) const {
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start);
    return {ErrorCode::Unavailable,
            std::string(Conversation::kName) + ": " +
                (line_->has_server() ? "the server did not answer" : "no server answered") +
                " within " + std::to_string(waited.count()) + " ms (domain " +
                std::to_string(options_.domain) + ", " + options_.server +
                (options_.security.empty() ? "" : ", security " + options_.security.string()) +
                ")" + (line_->has_server() ? "" : note_of_environment())};
  }

  ParticipantOptions options_;
  std::optional<Error> refusal_;        // of every request
  std::optional<RequestChannel> line_;  // unless
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
