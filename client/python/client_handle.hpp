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

/// A client that waits without the interpreter's lock, in slices between which Python hears of
/// signals (Ctrl-C), and that can be closed while others wait. Called with the lock.
class ClientHandle {
 public:
  /// \throws as link::Client.
  explicit ClientHandle(const link::ClientOptions& options);
  ~ClientHandle() { close(); }
  ClientHandle(const ClientHandle&) = delete;
  ClientHandle& operator=(const ClientHandle&) = delete;

  /// \throws Failure(InvalidInput) if it is closed.
  std::shared_ptr<link::Client> line() const;

  /// Ends every wait of other threads. What is in the outbox stays there for the next client.
  void close();

  /// As link::Client; an error if there is no server, or a signal's exception.
  Result<FetchReply> fetch(FetchRequest request) const;
  link::Client::OutboxState flush(std::chrono::milliseconds deadline) const;

  /// What a call brings that cannot be taken in slices. One that a signal ends goes on by itself
  /// until it has its answer or its time has passed, and nobody hears what came of it.
  /// \param call  made on another thread: has values of its own, and nothing of Python.
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

  /// The robot that is meant: a label is looked up at the server.
  /// \throws Failure as link::find_robot says.
  Digest find(const RobotName& robot) const;

 private:
  std::shared_ptr<link::Client> client_;  // null: closed
  /// Calls that are waited for, or were until a signal came; an end of them waits for its call.
  mutable std::vector<std::shared_ptr<void>> abandoned_;
};

/// Waits for newer than what is held, as link::Follower, in slices too.
std::shared_ptr<const Distribution> wait_for_newer(const link::Follower& follower,
                                                   const std::shared_ptr<const Distribution>& held,
                                                   std::chrono::milliseconds timeout);

}  // namespace kinship::python
