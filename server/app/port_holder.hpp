#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>

namespace kinship::app {

/// The holder of a UDP port of this machine.
struct PortHolder {
  std::uint64_t inode = 0;  ///< of the socket
  uid_t user = 0;
  pid_t process = 0;    ///< 0: not visible to this process, e.g. another user's
  std::string program;  ///< as `ps` calls it; empty without `process`
};

/// Reads it from /proc. \return nothing if the port is free.
std::optional<PortHolder> find_port_holder(std::uint16_t port);

}  // namespace kinship::app
