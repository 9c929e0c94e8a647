#pragma once

namespace kinship::dds {

/// As long as one lives, this process hears only of readers and writers that say what security
/// they have. Cyclone DDS 0.10.2 looks at the permissions of those only that say they are to be
/// checked, and takes others for what its own side is: with a certificate of any client, somebody
/// could write and read in the partition of another one. May be shared between threads.
///
/// For the whole process: Cyclone DDS tells nobody which domain a remote reader or writer is of.
class EndpointGuard {
 public:
  EndpointGuard();
  EndpointGuard(const EndpointGuard&) = delete;
  EndpointGuard& operator=(const EndpointGuard&) = delete;
  ~EndpointGuard();
};

/// Whether Cyclone DDS asks this library before it hears of a reader or writer: not if a program
/// loaded it before this library, or has another copy of this one.
bool is_endpoint_guard_in_place();

}  // namespace kinship::dds
