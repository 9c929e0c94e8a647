#pragma once

#include <sys/fsuid.h>
#include <unistd.h>

namespace kinship::link {

/// Files of root are another user's to this thread while it lives.
class AnotherUser {
 public:
  AnotherUser() { ::setfsuid(kNobody); }
  AnotherUser(const AnotherUser&) = delete;
  AnotherUser& operator=(const AnotherUser&) = delete;
  ~AnotherUser() { ::setfsuid(::geteuid()); }

  static bool is_root() { return ::setfsuid(static_cast<uid_t>(-1)) == 0; }

 private:
  static constexpr uid_t kNobody = 65534;
};

}  // namespace kinship::link
