#include "proto/dds/qos.hpp"

#include <dds/dds.h>

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
