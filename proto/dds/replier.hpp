#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>

#include "proto/codec/conversation.hpp"
#include "proto/codec/request_size.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/types/caller.hpp"

namespace kinship::dds {

/// Sends the reply to one request. Copyable; may be called from any thread, at any time, also after
/// the replier is gone (then nothing is sent).
///
/// The first call sends, later calls do nothing: a deadline and a late result may race. Never
/// called: the client's next resend of the request is handled anew.
template <typename Conversation>
class Answer {
 public:
  class State;
  explicit Answer(std::shared_ptr<State> state) : state_(std::move(state)) {}

  /// A reply that breaks a rule of the contract (too large, say) is replaced by a refusal that
  /// says so. Never throws.
  void operator()(const typename Conversation::Reply& reply) const noexcept;

  const codec::Head& head() const noexcept;  ///< of the request
  const Caller& caller() const noexcept;     ///< sender of the request

 private:
  std::shared_ptr<State> state_;  // shared by the copies; the last one frees the place
};

/// The server's side of a conversation: decodes requests and hands them over with an Answer.
///
/// A request that breaks a rule is refused with the reason and never reaches the handler. A
/// resend of a request that is being answered is dropped.
template <typename Conversation>
class Replier {
 public:
  /// Runs on the loop's thread. A Failure it throws becomes a refusal.
  using Handler = std::function<void(typename Conversation::Request, Answer<Conversation>)>;

  /// Called for each request before it is decoded, on the loop's thread; returns a reply to refuse
  /// it. Must not throw.
  using Gate = std::function<std::optional<typename Conversation::Reply>(
      const Caller&, const codec::RequestSize&)>;

  /// \param gate  empty: every request is admitted.
  /// \throws Failure(Internal) if an entity cannot be created.
  Replier(const Participant& participant, WaitLoop& loop, Handler handler, Gate gate = {});
  ~Replier();
  Replier(const Replier&) = delete;
  Replier& operator=(const Replier&) = delete;

  std::size_t clients() const;  ///< that can send a request now. Callable from any thread

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

extern template class Answer<codec::RegisterConversation>;
extern template class Answer<codec::ReportConversation>;
extern template class Answer<codec::FetchConversation>;
extern template class Answer<codec::AdminConversation>;
extern template class Replier<codec::RegisterConversation>;
extern template class Replier<codec::ReportConversation>;
extern template class Replier<codec::FetchConversation>;
extern template class Replier<codec::AdminConversation>;

}  // namespace kinship::dds
