#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/http/address.hpp"
#include "server/http/message.hpp"

namespace kinship::http {

/// Files of PEM that a server shows to be itself.
struct CertificateFiles {
  std::filesystem::path certificate, key;
};

/// What a port is for, in the message of one that cannot be had.
struct PortUse {
  std::string what;    ///< "metrics"
  std::string option;  ///< "--metrics"
  std::optional<CertificateFiles> tls = {};
};

/// A bound TCP port on which no listener answers yet.
class Port {
 public:
  /// \throws Failure(Unavailable) if it cannot be bound: taken, not permitted, or not an address of
  ///         this machine; or if the certificate cannot be used.
  Port(const Address& address, const PortUse& use);
  ~Port();
  Port(Port&& other) noexcept;
  Port& operator=(Port&& other) noexcept;

  Address address() const;  ///< with the port that it has
  /// http://127.0.0.1:9464 or https://...; with this machine's name if it serves all networks.
  std::string url() const;

 private:
  friend class Listener;
  struct State;
  std::unique_ptr<State> state_;
};

/// Limits of the connections to a port.
struct Limits {
  /// At a time; one more closes the oldest one without a stream, or the oldest of all.
  std::size_t connections = 16;
  std::size_t requests = 1;  ///< that one connection may make
  std::size_t header_bytes = 8192;
  std::size_t body_bytes = 0;
  std::size_t stream_bytes = 1U << 18U;  ///< that wait for a reader, before it is dropped
  /// From connection to request, for a reply, and for each part of a stream.
  std::chrono::milliseconds request_time{5000};
  std::chrono::milliseconds idle_time{30'000};  ///< from a reply to the end of the next request
  std::vector<std::string> hosts = {};          ///< see is_served_host()
  std::string host_option = {};                 ///< that adds one, for the message
};

/// Answers HTTP/1 on a thread of its own. A connection can slow down only other connections.
class Listener {
 public:
  Listener(Port port, Handler handler, Limits limits = {});
  ~Listener();  ///< the handler is not called after it; open connections are closed
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::http
