#pragma once

#include <chrono>
#include <memory>

#include "proto/codec/conversation.hpp"
#include "proto/dds/participant.hpp"
#include "proto/types/result.hpp"

namespace kinship::dds {

/// The client's side of a conversation. May be shared between threads: calls run side by side.
template <typename Conversation>
class Requester {
 public:
  using Clock = std::chrono::steady_clock;

  /// \param client_id  of this process; replies are found by it.
  /// \throws Failure(Internal) if an entity cannot be created.
  Requester(const Participant& participant, const Uuid& client_id);
  ~Requester();
  Requester(const Requester&) = delete;
  Requester& operator=(const Requester&) = delete;

  /// Sends the request and waits for its reply. Sends it again after 100 ms, 300 ms, then every
  /// second, and whenever a server appears: requests are idempotent.
  /// \return the reply; InvalidInput or TooLarge if the request breaks a rule, or if the role in
  ///         the participant's credentials may not use the conversation (the request is not sent);
  ///         Unavailable if no reply came until the deadline or cancel() was called; Internal if
  ///         the reply breaks a rule.
  Result<typename Conversation::Reply> call(const typename Conversation::Request& request,
                                            Clock::time_point deadline);

  /// Number of servers that have appeared since construction, a restarted one again: a change of
  /// the number shows a new server. Does not wait.
  std::uint64_t count_servers();

  /// Ends pending calls, and makes later ones end at once. For shutdown.
  void cancel();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

extern template class Requester<codec::RegisterConversation>;
extern template class Requester<codec::ReportConversation>;
extern template class Requester<codec::FetchConversation>;
extern template class Requester<codec::AdminConversation>;

}  // namespace kinship::dds
