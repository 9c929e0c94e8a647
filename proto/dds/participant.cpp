#include "proto/dds/participant.hpp"

#include <dds/dds.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <map>
#include <mutex>
#include <optional>

#include "proto/dds/endpoint_guard.hpp"
#include "proto/dds/log.hpp"
#include "proto/dds/loopback_guard.hpp"
#include "proto/dds/network_interface.hpp"
#include "proto/dds/packet_guard.hpp"
#include "proto/dds/qos.hpp"
#include "proto/dds/rejoin_watch.hpp"
#include "proto/dds/self_description.hpp"
#include "proto/security/enclave.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds {
namespace {

std::string describe_failure(const ParticipantOptions& options, Handle code) {
  const std::string port = std::to_string(discovery_port(options.domain, options.place));
  std::string message = "domain " + std::to_string(options.domain) + ": cannot join";
  if (options.role == Role::Server)
    message += " as its server at UDP port " + port;
  message += " (" + std::string(dds_strretcode(-code));
  if (const std::string line = last_log_line(); !line.empty())
    message += ": " + line;
  return message + ")" + note_of_environment();
}

/// What Cyclone DDS calls a domain in this process: the ROS domain of a number is another one. With
/// security it is the number itself, as Cyclone DDS looks this one up in what SROS 2 has signed.
std::uint32_t number_here(const ParticipantOptions& options) {
  const bool has_other_number = options.role == Role::RosNode && options.security.empty();
  return options.domain + (has_other_number ? kMaxDomain + 1 : 0);
}

// The process with the threads of Cyclone DDS, and its domains; the threads end with the last one.
std::atomic<pid_t> joined_process = 0;
std::atomic<int> joined_domains = 0;

/// \throws Failure(InvalidInput)
void require_threads(const ParticipantOptions& options) {
  if (joined_domains > 0 && joined_process != getpid())
    throw Failure(ErrorCode::InvalidInput, "domain " + std::to_string(options.domain) +
                                               ": cannot join: " + forked_process_advice());
}

void require_usable_interface(const ParticipantOptions& options) {
  const std::string name = chosen_interface(options);
  const std::string why = name.empty() ? "" : explain_unusable(name, network_interfaces());
  if (!why.empty())
    throw Failure(ErrorCode::Unavailable,
                  "domain " + std::to_string(options.domain) + ": cannot join: " + why);
}

}  // namespace

/// A domain of Cyclone DDS with its configuration. Cyclone DDS knows one per id and process.
class Participant::Domain {
 public:
  /// The domain of this id, made if this process has none yet.
  static std::shared_ptr<Domain> join(const ParticipantOptions& options) {
    require_threads(options);  // before the lock, which a thread left behind may have held
    static std::mutex mutex;   // guards domains
    static std::map<std::uint32_t, std::weak_ptr<Domain>> domains;
    const std::string configuration = cyclone_configuration(options);
    const std::lock_guard lock(mutex);
    std::weak_ptr<Domain>& known = domains[number_here(options)];
    if (auto domain = known.lock()) {
      const bool is_server_here = domain->role_ == Role::Server && options.role == Role::Client;
      if (domain->configuration_ != configuration && !is_server_here)
        throw Failure(ErrorCode::InvalidInput, "domain " + std::to_string(options.domain) +
                                                   ": this process uses it already, with "
                                                   "another server or role");
      // Cyclone DDS's access control knows one participant's permissions in a domain.
      if (domain->security_ != options.security)
        throw Failure(ErrorCode::InvalidInput, "domain " + std::to_string(options.domain) +
                                                   ": this process uses it already, with "
                                                   "other credentials");
      return domain;
    }
    auto domain = std::make_shared<Domain>(options, configuration);
    known = domain;
    return domain;
  }

  Domain(const ParticipantOptions& options, const std::string& configuration)
      : role_(options.role), security_(options.security), configuration_(configuration) {
    limit_log();
    if (std::getenv("CYCLONEDDS_URI") && role_ != Role::RosNode)
      return;  // the user's configuration, read by Cyclone DDS
    require_usable_interface(options);
    std::optional<LoopbackGuard> guard;
    if (chosen_interface(options) == "lo")
      guard.emplace();
    const Handle handle = dds_create_domain(number_here(options), configuration.c_str());
    if (handle < 0)
      throw Failure(ErrorCode::Unavailable, describe_failure(options, handle));
    entity_.emplace(handle, "domain");
  }

  bool is_of_server() const { return role_ == Role::Server; }

 private:
  /// Counts as long as the domain lives. The process first: whoever reads a count reads it, too.
  struct Counted {
    Counted() {
      joined_process = getpid();
      ++joined_domains;
    }
    ~Counted() { --joined_domains; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
  };

  Role role_;
  std::filesystem::path security_;
  std::string configuration_;
  Counted counted_;
  std::optional<Entity> entity_;
};

namespace {

/// \throws Failure(InvalidInput) for credentials that cannot join.
std::optional<security::Credentials> credentials_of(const ParticipantOptions& options) {
  if (options.security.empty())
    return std::nullopt;
  if (options.role == Role::RosNode) {
    security::require_enclave(options.security);
    return std::nullopt;
  }
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  security::Credentials credentials =
      security::read_credentials(options.security, now).value_or_throw();
  const bool is_server = credentials.role == security::kServerName;
  if (is_server != (options.role == Role::Server))
    throw Failure(ErrorCode::InvalidInput,
                  "security '" + options.security.string() + "': has the credentials of " +
                      (is_server ? "the server, a client needs its own (kinshipd secure add)"
                                 : "client '" + credentials.name + "', not of a server"));
  return credentials;
}

/// \throws Failure(InvalidInput) if it would not be asked.
std::unique_ptr<EndpointGuard> guard_of(const ParticipantOptions& options) {
  if (options.security.empty())
    return nullptr;
  if (!is_endpoint_guard_in_place())
    throw Failure(ErrorCode::InvalidInput,
                  "domain " + std::to_string(options.domain) +
                      ": cannot join with security: this process loaded Cyclone DDS (libddsc), or "
                      "another copy of Kinship, first, so that what Kinship checks about others' "
                      "readers and writers would not be asked; load Kinship before it");
  return std::make_unique<EndpointGuard>();
}

/// One at a time: of two that are the first of their domain Cyclone DDS 0.10.2 loads the plugins of
/// security twice, and the one's identity is unknown to the other's.
Entity create_participant(const ParticipantOptions& options) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  Qos qos = options.security.empty()        ? Qos(dds_create_qos())
            : options.role == Role::RosNode ? enclave_qos(options.security)
                                            : security_qos(options.security);
  if (options.security.empty() && options.role == Role::Client)
    set_description(qos.get(), own_description());
  const Handle handle = dds_create_participant(number_here(options), qos.get(), nullptr);
  if (handle < 0)
    throw Failure(ErrorCode::Unavailable, describe_failure(options, handle));
  return {handle, "participant"};
}

}  // namespace

std::string forked_process_advice() {
  return "this process was forked from one that has a client, whose threads do not come along; "
         "start it anew (Python: multiprocessing.set_start_method(\"spawn\") or "
         "get_context(\"spawn\"); otherwise exec), or open the first client after the fork";
}

std::string note_of_environment() {
  const char* const value = std::getenv("CYCLONEDDS_URI");
  if (value == nullptr)
    return "";
  return "; CYCLONEDDS_URI is set ('" + std::string(value) +
         "') and replaces Kinship's own configuration, which names the server as a peer and the "
         "network interface: is it readable, well-formed and meant for this? Without it (unset "
         "CYCLONEDDS_URI) Kinship's own is used";
}

Participant::Participant(const ParticipantOptions& options)
    : options_(options),
      credentials_(credentials_of(options)),
      guard_(guard_of(options)),
      packets_(options.role != Role::Client
                   ? std::make_unique<PacketGuard>(!options.security.empty())
                   : nullptr),
      domain_(Domain::join(options)),
      entity_(create_participant(options)),
      rejoin_(credentials_ && !domain_->is_of_server()
                  ? std::make_unique<RejoinWatch>(entity_.get())
                  : nullptr) {}

Participant::~Participant() = default;
Participant::Participant(Participant&&) noexcept = default;

}  // namespace kinship::dds
