#pragma once

#include <string>
#include <vector>

namespace kinship {

/// What the certificate of a client is for.
enum class AccessRole {
  Robot,     ///< registers itself, reports as itself, fetches, follows
  Reader,    ///< fetches, lists, shows
  Operator,  ///< a reader that also retires, resets, evicts, controls jobs and makes backups
  Admin      ///< everything
};

/// Who sent a request, as far as the server knows it by itself: nothing here is taken from the
/// request. What is not said is the least: a caller of which nothing is known may next to nothing.
struct Caller {
  /// Whom quotas count: the name in the certificate; without security the participant.
  std::string client = {};
  std::string name = {};                 ///< in the certificate; empty without security
  AccessRole role = AccessRole::Robot;   ///< without security Admin, where it asks from decides
  std::vector<std::string> tasks = {};   ///< patterns (`*`, `?`) it is narrowed to; empty: all
  std::vector<std::string> robots = {};  ///< labels it is narrowed to; empty: all
  bool is_local = false;                 ///< on the server's machine; not asked with security
};

}  // namespace kinship
