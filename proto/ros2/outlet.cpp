#include "proto/ros2/outlet.hpp"

#include <dds/dds.h>

#include "proto/dds/matched_writers.hpp"
#include "proto/types/failure.hpp"

namespace kinship::ros2 {

dds::Qos node_qos(Durability durability, int depth) {
  dds::Qos qos(dds_create_qos());
  if (!qos)
    throw Failure(ErrorCode::Internal, "dds_create_qos: out of memory");
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, depth);
  dds_qset_writer_data_lifecycle(qos.get(), false);
  if (durability == Durability::Volatile)
    return qos;
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  return qos;
}

dds::Entity make_topic(const dds::Participant& participant, const dds_topic_descriptor& type,
                       const std::string& name) {
  return {dds_create_topic(participant.get(), &type, name.c_str(), nullptr, nullptr),
          "topic " + name};
}

Outlet::Outlet(const dds::Participant& participant, const dds_topic_descriptor& type,
               const std::string& name, const dds::Qos& qos)
    : topic_(make_topic(participant, type, name)),
      writer_(dds_create_writer(participant.get(), topic_.get(), qos.get(), nullptr),
              "writer " + name) {}

void Outlet::write(const void* sample) const noexcept { dds_write(writer_.get(), sample); }

std::optional<std::set<std::string>> Outlet::nodes() const {
  return dds::clients_of_readers(writer_);
}

}  // namespace kinship::ros2
