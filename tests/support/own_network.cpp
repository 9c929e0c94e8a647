#include "tests/support/own_network.hpp"

#include <linux/capability.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

namespace kinship::test {
namespace {

bool write_line(const char* file, const std::string& line) {
  std::ofstream stream(file);
  stream << line << std::flush;
  return stream.good();
}

/// In a new user namespace: everybody is who they were outside.
bool map_user(uid_t user, gid_t group) {
  const auto identity = [](unsigned id) {
    return std::to_string(id) + " " + std::to_string(id) + " 1";
  };
  return write_line("/proc/self/setgroups", "deny") &&
         write_line("/proc/self/uid_map", identity(user)) &&
         write_line("/proc/self/gid_map", identity(group));
}

bool raise_loopback() {
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  const int any = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const bool is_up = ioctl(any, SIOCSIFFLAGS, &request) == 0;
  close(any);
  return is_up;
}

/// A new user namespace gives every capability inside of it, and with them the right to read what
/// file modes forbid.
bool drop_capabilities() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  const __user_cap_data_struct none[_LINUX_CAPABILITY_U32S_3] = {};
  return syscall(SYS_capset, &header, none) == 0;
}

bool enter() {
  if (unshare(CLONE_NEWNET) == 0)
    return raise_loopback();
  const uid_t user = geteuid();
  const gid_t group = getegid();
  return unshare(CLONE_NEWUSER | CLONE_NEWNET) == 0 && map_user(user, group) && raise_loopback() &&
         drop_capabilities();
}

/// Tried in a child: who fails half way has no way back.
bool is_permitted() {
  const pid_t child = fork();
  if (child == 0)
    _exit(enter() ? 0 : 1);
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

}  // namespace

bool enter_own_network() {
  constexpr const char* kEntered = "KINSHIP_TEST_HAS_OWN_NETWORK";  // inherited, as the network is
  if (std::getenv(kEntered))
    return true;
  return is_permitted() && enter() && setenv(kEntered, "1", 1) == 0;
}

}  // namespace kinship::test
