#include "proto/dds/qos.hpp"

#include <dds/dds.h>
#include <dlfcn.h>

#include <filesystem>

#include "proto/security/credentials.hpp"
#include "proto/security/enclave.hpp"
#include "proto/security/permissions.hpp"
#include "proto/types/failure.hpp"

namespace kinship::dds {
namespace {

constexpr std::int32_t kReplyDepth = 64;
constexpr std::int32_t kEventDepth = 64;

Qos make_qos() {
  Qos qos(dds_create_qos());
  if (!qos)
    throw Failure(ErrorCode::Internal, "dds_create_qos: out of memory");
  return qos;
}

Qos reliable_volatile_qos() {
  Qos qos = make_qos();
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

/// A plugin of Cyclone DDS's security. Debian has them in a folder beside Cyclone DDS's library
/// that is called after it; elsewhere the system's search finds them.
std::string security_plugin(const std::string& name) {
  Dl_info library{};
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dladdr asks for
  if (dladdr(reinterpret_cast<void*>(&dds_create_participant), &library) != 0) {
    const std::filesystem::path file = std::filesystem::path(library.dli_fname).parent_path() /
                                       "libddsc0debian" / ("libdds_security_" + name + ".so");
    std::error_code error;
    if (std::filesystem::exists(file, error))
      return file.string();
  }
  return "dds_security_" + name;
}

void set_plugin(dds_qos_t* qos, const std::string& role, const std::string& file,
                const std::string& suffix) {
  const std::string library = "dds.sec." + role + ".library.";
  dds_qset_prop(qos, (library + "path").c_str(), security_plugin(file).c_str());
  dds_qset_prop(qos, (library + "init").c_str(), ("init_" + suffix).c_str());
  dds_qset_prop(qos, (library + "finalize").c_str(), ("finalize_" + suffix).c_str());
}

Qos plugins_qos(const security::EnclaveFiles& files) {
  Qos qos = make_qos();
  set_plugin(qos.get(), "auth", "auth", "authentication");
  set_plugin(qos.get(), "access", "ac", "access_control");
  set_plugin(qos.get(), "crypto", "crypto", "crypto");
  const auto set_file = [&](const char* property, const std::filesystem::path& file) {
    dds_qset_prop(qos.get(), property, ("file:" + file.string()).c_str());
  };
  set_file("dds.sec.auth.identity_ca", files.identity_authority);
  set_file("dds.sec.auth.identity_certificate", files.certificate);
  set_file("dds.sec.auth.private_key", files.key);
  set_file("dds.sec.access.permissions_ca", files.permissions_authority);
  set_file("dds.sec.access.governance", files.governance);
  set_file("dds.sec.access.permissions", files.permissions);
  return qos;
}

}  // namespace

void DeleteQos::operator()(dds_qos* qos) const noexcept { dds_delete_qos(qos); }

Qos request_qos() {
  Qos qos = reliable_volatile_qos();
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0);
  return qos;
}

Qos request_reader_qos(int depth) {
  Qos qos = reliable_volatile_qos();
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  return qos;
}

Qos reply_qos() {
  Qos qos = reliable_volatile_qos();
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kReplyDepth);
  return qos;
}

Qos announcement_qos() {
  Qos qos = reliable_volatile_qos();
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return qos;
}

Qos event_qos() {
  Qos qos = reliable_volatile_qos();
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kEventDepth);
  return qos;
}

Qos security_qos(const std::filesystem::path& credentials) {
  const security::CredentialFiles files(std::filesystem::absolute(credentials));
  Qos qos = plugins_qos({.identity_authority = files.authorities,
                         .certificate = files.certificate,
                         .key = files.key,
                         .permissions_authority = files.authorities,
                         .governance = files.governance,
                         .permissions = files.permissions});
  // A folder, not a URI: while authorities change, others' certificates are of either.
  dds_qset_prop(qos.get(), "dds.sec.auth.trusted_ca_dir", files.trusted.c_str());
  return qos;
}

Qos enclave_qos(const std::filesystem::path& enclave) {
  return plugins_qos(security::EnclaveFiles::in(std::filesystem::absolute(enclave)));
}

std::string client_partition(const Participant& participant) {
  return security::client_partition(participant.credentials().value().name);
}

Qos partition_qos(const std::string& partition) {
  Qos qos = make_qos();
  const char* name = partition.c_str();
  dds_qset_partition(qos.get(), 1, &name);
  return qos;
}

std::string reply_partition(unsigned number) {
  return (number < 10 ? "reply_0" : "reply_") + std::to_string(number);
}

unsigned reply_partition_of(const Uuid& client_id) {
  // Fowler, Noll, Vo: FNV-1a, 32 bits.
  std::uint32_t hash = 2166136261U;
  for (const std::uint8_t byte : client_id.bytes)
    hash = (hash ^ byte) * 16777619U;
  return hash % kReplyPartitions;
}

}  // namespace kinship::dds
