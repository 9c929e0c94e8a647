#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>

#include "proto/dds/entity.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/qos.hpp"

struct dds_topic_descriptor;

namespace kinship::ros2 {

/// Readers that come later get the last samples of a TransientLocal writer, which keeps `depth`.
enum class Durability { Volatile, TransientLocal };

/// As ROS nodes have it by default, reliable, keep last, no partition.
/// \param depth  of this side alone: the other side has its own.
dds::Qos node_qos(Durability durability, int depth);

/// A topic as ROS names it. \param name  e.g. "rt/kinship/report".
dds::Entity make_topic(const dds::Participant& participant, const dds_topic_descriptor& type,
                       const std::string& name);

/// Publishes one kind of message. May be shared between threads.
class Outlet {
 public:
  /// \throws Failure(Internal) if an entity cannot be made.
  Outlet(const dds::Participant& participant, const dds_topic_descriptor& type,
         const std::string& name, const dds::Qos& qos);

  /// \param sample  of that type. A slow reader loses samples and delays no others.
  void write(const void* sample) const noexcept;

  /// The nodes that read it now (Caller::client); nothing if that cannot be known.
  std::optional<std::set<std::string>> nodes() const;

 private:
  dds::Entity topic_;
  dds::Entity writer_;
};

}  // namespace kinship::ros2
