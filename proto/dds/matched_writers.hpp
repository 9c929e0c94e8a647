#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include "proto/dds/entity.hpp"
#include "proto/dds/participant.hpp"

struct dds_qos;

namespace kinship::dds {

/// Whether a sender receives the replies to its requests.
enum class Hearing {
  Unknown,
  Heard,    ///< a reader of its participant was there
  Awaited,  ///< was waited for once; not again
};

/// The sender of requests, as known from DDS, not from the request.
struct Sender {
  /// The client's name; without security the identifier of its participant, which differs in each
  /// process.
  std::string client;
  std::string name = {};     ///< common name of its certificate; empty without security
  bool is_local = false;     ///< its packets come from this machine (packet_guard)
  std::string address = {};  ///< that its packets come from; empty: it is in this process
  // What its participant says of itself (participant.hpp), without security.
  std::string host = {}, program = {};
  std::uint64_t participant = 0;  ///< its instance handle
  Hearing hearing = Hearing::Unknown;
};

/// Looks up the senders of samples by their writers, and caches them. For sources of proto/dds
/// only; not to be shared between threads.
class MatchedWriters {
 public:
  explicit MatchedWriters(const Participant& participant);

  /// \param reader  that took the sample.
  /// \param writer  its publication handle.
  /// \return null if the writer is gone, or is in no partition of one client (with security); valid
  ///         until the next call.
  Sender* find(const Entity& reader, std::uint64_t writer);

  /// The clients whose writers a reader has matched now; nothing if that cannot be known.
  std::optional<std::set<std::string>> clients(const Entity& reader);

  void forget_heard();  ///< some reader has gone

 private:
  std::optional<Sender> look_up(const Entity& reader, std::uint64_t writer) const;
  void describe(Sender& sender) const;

  bool has_security_;
  Entity participants_;                              // reader of the built-in topic of participants
  std::unordered_map<std::uint64_t, Sender> known_;  // by writer
};

/// The clients, by participant, whose readers a writer has matched now; nothing if that cannot be
/// known.
std::optional<std::set<std::string>> clients_of_readers(const Entity& writer);

/// The common name of the client's certificate if the QoS of a reader or writer has that client's
/// partition and no other.
std::optional<std::string> client_of_partitions(const dds_qos* qos);

}  // namespace kinship::dds
