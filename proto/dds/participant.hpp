#pragma once

#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "proto/dds/entity.hpp"
#include "proto/security/credentials.hpp"
#include "proto/types/caller.hpp"
#include "proto/types/result.hpp"

namespace kinship::dds {

/// The process that created an object with threads of Cyclone DDS or of Kinship. A process forked
/// from it has the object without the threads: calls get no answer, and a destructor waits for
/// ever.
class OwningProcess {
 public:
  /// Whether this is a process forked from the owner.
  bool is_forked() const { return getpid() != id_; }

 private:
  pid_t id_ = getpid();
};

/// Advice for a forked process, as text.
std::string forked_process_advice();

class EndpointGuard;
class PacketGuard;
class RejoinWatch;

enum class Role {
  Server,  ///< takes a discovery port of the domain, by its place; knows no peers
  Client,  ///< announces itself to the places of a server, never to other clients
  RosNode  ///< found, and finds others, as ROS 2 nodes do; of a server
};

/// Places that a server may have in its domain, as participant indices of DDS: where other software
/// (a ROS node) has the first one, it takes the next. Clients ask at all of them.
inline constexpr std::uint32_t kServerPlaces = 8;

/// Looks up a client by the name in its certificate; an error, which is sent to the client, if the
/// server does not know that name, or not any more. Called for each request: has to be quick.
/// Called from any thread.
using Directory = std::function<Result<Caller>(const std::string& name)>;

struct ParticipantOptions {
  std::uint32_t domain = 0;  ///< 0 to kMaxDomain
  Role role = Role::Client;
  std::uint32_t place = 0;           ///< of a server, below kServerPlaces
  std::string server = "127.0.0.1";  ///< client: host of kinshipd
  /// E.g. "eth0". Empty: at a server, or for a server on a loopback address, "lo"; otherwise
  /// Cyclone DDS chooses.
  std::string network_interface = {};
  /// Folder of credentials (kinshipd secure), of a RosNode an enclave of SROS 2: only participants
  /// with certificates of the same authority are accepted. Empty: no security.
  std::filesystem::path security = {};
  Directory directory = {};  ///< of a server with security; without one it refuses every client
};

inline constexpr std::uint32_t kMaxDomain = 230;  ///< ports stay below 65536
inline constexpr std::chrono::seconds kLease{5};  ///< a silent participant is gone after it

/// UDP port of discovery at a place of a domain: 7400 + 250 domain + 10 + 2 place.
std::uint16_t discovery_port(std::uint32_t domain, std::uint32_t place = 0);

/// UDP ports that the server of a domain needs: discovery_port(), and the next one for data.
std::array<std::uint16_t, 2> server_ports(std::uint32_t domain, std::uint32_t place = 0);

/// Name of the network interface that a participant asks for: the one of its options; loopback for
/// servers without one and for clients of this machine; empty: Cyclone DDS chooses.
/// \throws Failure(InvalidInput) for an invalid name.
std::string chosen_interface(const ParticipantOptions& options);

/// The configuration of Cyclone DDS for a participant, as XML: a star over unicast; of a RosNode,
/// what ROS 2 nodes have. \throws Failure(InvalidInput) for an invalid domain or host.
std::string cyclone_configuration(const ParticipantOptions& options);

/// A note that CYCLONEDDS_URI is set, with its value and consequence, to append to a message about
/// a failed search or join; empty if it is not set.
std::string note_of_environment();

/// A member of a DDS domain: root of every other entity. May be shared between threads.
///
/// If CYCLONEDDS_URI is set in the environment it replaces the built-in configuration, but not that
/// of a RosNode. All
/// participants of a process on one domain share one configuration and one folder of credentials.
class Participant {
 public:
  /// \throws Failure(InvalidInput) if the options are invalid, also for unusable credentials;
  ///         Failure(Unavailable) if the domain cannot be joined, e.g. because its discovery port
  ///         is taken by another server, or this process was forked from one that is in a domain: a
  ///         fork does not copy threads of Cyclone DDS.
  explicit Participant(const ParticipantOptions& options);
  ~Participant();
  Participant(Participant&&) noexcept;

  Handle get() const noexcept { return entity_.get(); }
  const ParticipantOptions& options() const noexcept { return options_; }

  /// Name and role with which it joined; nothing without security, and of a RosNode.
  const std::optional<security::Credentials>& credentials() const noexcept { return credentials_; }

 private:
  class Domain;

  ParticipantOptions options_;
  std::optional<security::Credentials> credentials_;
  std::unique_ptr<EndpointGuard> guard_;  // with security
  std::unique_ptr<PacketGuard> packets_;  // of a server or a node of it
  std::shared_ptr<Domain> domain_;  // shared by the participants of this process on one domain
  Entity entity_;
  std::unique_ptr<RejoinWatch> rejoin_;  // of a client with security; last: uses the others
};

}  // namespace kinship::dds
