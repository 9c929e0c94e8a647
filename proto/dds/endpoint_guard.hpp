#pragma once

namespace kinship::dds {

/// While one lives, this process discovers only remote readers and writers that announce their
/// security attributes. Cyclone DDS 0.10.2 checks the permissions only of endpoints that announce
/// them, and assumes its own attributes for others: a process with any client's certificate could
/// write and read in the partition of another client. May be shared between threads.
///
/// For the whole process: Cyclone DDS does not expose the domain of a remote reader or writer.
class EndpointGuard {
 public:
  EndpointGuard();
  EndpointGuard(const EndpointGuard&) = delete;
  EndpointGuard& operator=(const EndpointGuard&) = delete;
  ~EndpointGuard();
};

/// Whether Cyclone DDS calls this library before it discovers a reader or writer: not if a program
/// loaded Cyclone DDS before this library, or has another copy of this library.
bool is_endpoint_guard_in_place();

}  // namespace kinship::dds
