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

/// Whether a caller without a certificate has shown the server's token
/// (proto/security/admin_token).
enum class TokenProof {
  NotNeeded,  ///< the server asks for none: its own machine is trusted
  Missing,
  Wrong,  ///< another token, or a request that was sent before
  Shown
};

/// Sender of a request, as known to the server: no field is what the request says of its sender.
/// Defaults are the lowest rights: an unknown caller has almost none.
struct Caller {
  /// The client for quotas: the name in the certificate; without security the participant.
  std::string client = {};
  std::string name = {};                 ///< in the certificate; empty without security
  AccessRole role = AccessRole::Robot;   ///< without security Admin; then is_local and token decide
  std::vector<std::string> tasks = {};   ///< patterns (`*`, `?`) that it is limited to; empty: all
  std::vector<std::string> robots = {};  ///< labels that it is limited to; empty: all
  bool is_local = false;     ///< by the address of its packets; decides nothing with security
  std::string address = {};  ///< its packets' own; empty: the caller is in the server's process
  TokenProof token = TokenProof::NotNeeded;
  // What the participant says of itself, without security; for people, and decides nothing.
  std::string host = {}, program = {};
};

}  // namespace kinship
