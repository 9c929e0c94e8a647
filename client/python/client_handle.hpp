#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "client/link/client.hpp"
#include "client/python/bindings.hpp"

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

  /// The robot that is meant: a label is looked up at the server.
  /// \throws Failure as link::find_robot says.
  Digest find(const RobotName& robot) const;

 private:
  std::shared_ptr<link::Client> client_;  // null: closed
};

/// Waits for newer than what is held, as link::Follower, in slices too.
std::shared_ptr<const Distribution> wait_for_newer(const link::Follower& follower,
                                                   const std::shared_ptr<const Distribution>& held,
                                                   std::chrono::milliseconds timeout);

}  // namespace kinship::python
