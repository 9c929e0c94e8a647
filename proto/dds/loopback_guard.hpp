#pragma once

namespace kinship::dds {

/// While one lives, sockets that Cyclone DDS opens on this thread for all addresses of the machine
/// are for its loopback address alone. Cyclone DDS 0.10.2 sends by the interface that it is told,
/// but hears on all: who is told "lo" would be heard by the network.
class LoopbackGuard {
 public:
  LoopbackGuard();
  LoopbackGuard(const LoopbackGuard&) = delete;
  LoopbackGuard& operator=(const LoopbackGuard&) = delete;
  ~LoopbackGuard();
};

}  // namespace kinship::dds
