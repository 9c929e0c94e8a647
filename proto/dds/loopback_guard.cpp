#include "proto/dds/loopback_guard.hpp"

#include <dds/ddsrt/sockets.h>
#include <dlfcn.h>
#include <netinet/in.h>

#include <cstring>

namespace kinship::dds {
namespace {

thread_local int loopback_guards = 0;

}  // namespace

LoopbackGuard::LoopbackGuard() { ++loopback_guards; }
LoopbackGuard::~LoopbackGuard() { --loopback_guards; }

}  // namespace kinship::dds

/// In front of the function of this name in Cyclone DDS, which binds each of its sockets: a
/// program's own symbols come before those of libraries.
extern "C" __attribute__((visibility("default"))) dds_return_t ddsrt_bind(ddsrt_socket_t socket,
                                                                          const sockaddr* address,
                                                                          socklen_t length) {
  static const auto kBehind = reinterpret_cast<decltype(&ddsrt_bind)>(
      dlsym(RTLD_NEXT, "ddsrt_bind"));  // NOLINT: what dlsym is for
  sockaddr_in own{};
  if (kinship::dds::loopback_guards == 0 || address->sa_family != AF_INET || length < sizeof own)
    return kBehind(socket, address, length);
  std::memcpy(&own, address, sizeof own);
  if (own.sin_addr.s_addr == htonl(INADDR_ANY))
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return kBehind(socket, reinterpret_cast<const sockaddr*>(&own), sizeof own);  // NOLINT: sockets'
}
