#pragma once

namespace kinship::dds {

/// While one lives, sockets that Cyclone DDS opens on this thread for all addresses of the machine
/// are bound to its loopback address alone. Cyclone DDS 0.10.2 sends on the configured interface
/// but listens on all: with "lo" it would still receive from the network.
class LoopbackGuard {
 public:
  LoopbackGuard();
  LoopbackGuard(const LoopbackGuard&) = delete;
  LoopbackGuard& operator=(const LoopbackGuard&) = delete;
  ~LoopbackGuard();
};

}  // namespace kinship::dds
