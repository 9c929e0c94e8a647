#pragma once

#include <concepts>
#include <functional>
#include <memory>

#include "proto/codec/conversation.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/types/caller.hpp"

namespace kinship::dds {

/// The server's side of a publication. May be shared between threads.
template <typename Publication>
class Publisher {
 public:
  using Value = typename Publication::Value;
  /// Whether a client may receive a value; with security each client has a writer of its own.
  using MayHear = std::function<bool(const Caller&, const Value&)>;

  /// \param loop      whose thread notices clients, with security; it outlives the publisher and
  ///                  does not run yet.
  /// \param may_hear  called with security, from any thread; empty: every client may.
  /// \throws Failure(Internal) if an entity cannot be created.
  Publisher(const Participant& participant, WaitLoop& loop, MayHear may_hear = {});
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Sends to all subscribers; a slow subscriber loses samples and does not delay others. A value
  /// that breaks a rule of the contract is not sent. Never throws.
  void publish(const Value& value) const noexcept;

  /// Withdraws the announcement of a distribution: later subscribers do not receive it. Never
  /// throws.
  void withdraw(const Digest& distribution_id)
      const noexcept requires std::same_as<Publication, codec::AnnouncementPublication>;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// The client's side of a publication, with a thread of its own that calls the handlers, one call
/// at a time. A handler must not throw, may take its time and use other entities, but not destroy
/// the subscriber.
template <typename Publication>
class Subscriber {
 public:
  struct Handlers {
    std::function<void(const typename Publication::Value&)> on_sample;
    /// Called when a new server appears, at first or after a restart. May be empty.
    std::function<void()> on_server;
    /// Called when a server has gone: at once if it ended, after the lease of discovery if it died.
    /// May be empty.
    std::function<void()> on_server_gone = {};
  };

  /// \throws Failure(Internal) if an entity cannot be created; Failure(InvalidInput) if the role in
  ///         the participant's credentials may not receive it.
  Subscriber(const Participant& participant, Handlers handlers);

  /// Waits for the running handler; none is called afterwards.
  ~Subscriber();
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

extern template class Publisher<codec::AnnouncementPublication>;
extern template class Publisher<codec::EventPublication>;
extern template class Subscriber<codec::AnnouncementPublication>;
extern template class Subscriber<codec::EventPublication>;

}  // namespace kinship::dds
