#pragma once

#include <string>
#include <vector>

namespace kinship {

/// Role of a client, in its certificate.
enum class AccessRole {
  Robot,     ///< registers itself, reports as itself, fetches, follows
  Reader,    ///< fetches, lists, shows
  Operator,  ///< a reader that also retires, resets, evicts, controls jobs and makes backups
  Admin      ///< everything
};

/// Sender of a request, as known to the server: no field is taken from the request. Defaults are
/// the lowest rights: an unknown caller has almost none.
struct Caller {
  /// The client for quotas: the name in the certificate; without security the participant.
  std::string client = {};
  std::string name = {};                 ///< in the certificate; empty without security
  AccessRole role = AccessRole::Robot;   ///< without security Admin; then is_local decides
  std::vector<std::string> tasks = {};   ///< patterns (`*`, `?`) that it is limited to; empty: all
  std::vector<std::string> robots = {};  ///< labels that it is limited to; empty: all
  bool is_local = false;                 ///< on the server's machine; not used with security
};

}  // namespace kinship
