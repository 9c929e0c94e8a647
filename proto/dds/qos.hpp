#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "proto/dds/participant.hpp"
#include "proto/types/uuid.hpp"

struct dds_qos;

/// The QoS of every entity; proto/CONTRACT.md has it for other languages.
namespace kinship::dds {

struct DeleteQos {
  void operator()(dds_qos* qos) const noexcept;
};
using Qos = std::unique_ptr<dds_qos, DeleteQos>;

/// Of a client's writer: reliable, keep all, volatile; blocks for at most 100 ms.
Qos request_qos();

/// Of the server's reader: reliable, keep last `depth`, volatile. A bound for memory: a reader
/// holds them until they are taken.
Qos request_reader_qos(int depth);

/// Reliable, keep last 64, volatile, without autodispose: a writer never blocks, and the client
/// resends the request of a lost reply.
Qos reply_qos();

/// Both sides of announcements: reliable, the newest of each distribution, also for readers that
/// come later (transient local), without autodispose.
Qos announcement_qos();

/// Both sides of events: reliable, keep last 64, volatile: a late or slow subscriber misses some.
Qos event_qos();

/// Of a participant with security: the plugins of Cyclone DDS, and their files.
Qos security_qos(const std::filesystem::path& credentials);

/// The same of an enclave of SROS 2.
Qos enclave_qos(const std::filesystem::path& enclave);

/// Partition of a client with security, for all its writers and readers. \pre it has credentials.
std::string client_partition(const Participant& participant);

/// Of a publisher or subscriber in one partition.
Qos partition_qos(const std::string& partition);

inline constexpr unsigned kReplyPartitions = 16;

/// Partitions of all clients, for the server's readers in a domain with security.
inline constexpr const char* kAllClients = "client_*";

std::string reply_partition(unsigned number);  ///< "reply_00" to "reply_15"

/// Number of the partition in which a client reads replies: FNV-1a (32 bits) of the 16 bytes of
/// its id, modulo 16. So a reply reaches a sixteenth of the clients, not all of them.
unsigned reply_partition_of(const Uuid& client_id);

}  // namespace kinship::dds
