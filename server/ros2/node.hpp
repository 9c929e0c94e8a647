#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "proto/types/publications.hpp"
#include "server/service/service.hpp"

namespace kinship::ros2 {

struct NodeOptions {
  std::uint32_t domain = 0;       ///< ROS_DOMAIN_ID
  std::string network_interface;  ///< empty: loopback
  std::filesystem::path enclave;  ///< folder of SROS 2's files; empty: no security
};

/// kinshipd as a ROS 2 node: topics and services of client/ros2/kinship_msgs to the same service
/// that Kinship's own conversations go to, on a thread of its own.
class Node {
  class Implementation;

 public:
  /// Joins the domain.
  /// \throws Failure(Unavailable) if that fails; Failure(NotFound) that names a missing file of the
  ///         enclave.
  explicit Node(const NodeOptions& options);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Nodes that follow a distribution get its newer revision. Callable from any thread, also before
  /// it serves.
  void announce(const Announcement& announcement);

  /// Serves a service for as long as it lives. Its end takes no more questions, and returns when
  /// the one that is being read has been read; answers of the service still leave.
  class Serving {
   public:
    /// One for each node. \param node, service  outlive the object.
    Serving(Node& node, service::Service& service);
    Serving(const Serving&) = delete;
    Serving& operator=(const Serving&) = delete;
    ~Serving();

   private:
    Implementation& node_;
  };

 private:
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::ros2
