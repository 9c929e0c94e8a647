#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/link/client.hpp"
#include "client/python/bindings.hpp"
#include "client/python/waiting.hpp"

namespace kinship::python {

/// A client that waits without the interpreter's lock, in slices between which Python handles
/// signals (Ctrl-C), and that can be closed while other threads wait. Called with the lock.
class ClientHandle {
 public:
  /// \throws as link::Client.
  explicit ClientHandle(const link::ClientOptions& options);
  ~ClientHandle() { close(); }
  ClientHandle(const ClientHandle&) = delete;
  ClientHandle& operator=(const ClientHandle&) = delete;

  /// \throws Failure(InvalidInput) if it is closed.
  std::shared_ptr<link::Client> line() const;

  /// Ends every wait of other threads. The outbox keeps its reports for the next client.
  void close();

  /// As link::Client; an error if there is no server, or a signal's exception.
  Result<FetchReply> fetch(FetchRequest request) const;

  /// The same, and waits for the rehearsal: in one request, as the server rests from it while none
  /// waits.
  Result<FetchReply> fetch_rehearsed(FetchRequest request) const;
  link::Client::OutboxState flush(std::chrono::milliseconds deadline) const;

  /// The reply of a call that cannot be made in slices. After a signal the call continues until its
  /// reply or timeout, and its result is discarded.
  /// \param call  runs on another thread: owns its values and uses no Python object.
  template <typename Reply>
  Reply wait_for(std::function<Reply(link::Client&)> call) const {
    const auto reply = std::make_shared<std::future<Reply>>(std::async(
        std::launch::async, [client = line(), call = std::move(call)] { return call(*client); }));
    abandoned_.push_back(reply);  // until it is known that it was not
    wait_until([&](std::chrono::milliseconds slice) {
      return reply->wait_for(slice) == std::future_status::ready;
    });
    std::erase(abandoned_, reply);
    return reply->get();
  }

  /// The robot's digest; a label is looked up at the server.
  /// \throws Failure as link::find_robot.
  Digest find(const RobotName& robot) const;

 private:
  std::shared_ptr<link::Client> client_;  // null: closed
  /// Calls under way, also those that a signal abandoned; destroying one waits for its end.
  mutable std::vector<std::shared_ptr<void>> abandoned_;
};

/// Waits for a newer distribution than `held`, as link::Follower, also in slices.
std::shared_ptr<const Distribution> wait_for_newer(const link::Follower& follower,
                                                   const std::shared_ptr<const Distribution>& held,
                                                   std::chrono::milliseconds timeout);

}  // namespace kinship::python
