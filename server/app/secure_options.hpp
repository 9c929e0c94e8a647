#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT: theirs
class App;
}

namespace kinship::app {

enum class SecureVerb {
  Init,
  Add,
  Renew,
  RenewServer,
  Revoke,
  List,
  RenewAuthority,
  RetireAuthority
};

/// A verb on a security folder, and its options.
struct SecureOptions {
  SecureVerb verb = SecureVerb::List;
  std::filesystem::path folder = {};
  std::filesystem::path authority_key = {};  ///< empty: in the folder
  std::string name = {};                     ///< of a client
  std::string role = {};
  std::vector<std::string> tasks = {};   ///< patterns; empty: all
  std::vector<std::string> robots = {};  ///< labels; empty: all
  int days = 365;
  std::filesystem::path out = {};  ///< credentials folder of the client
  bool json = false;
  bool force = false;
  bool leaked = false;  ///< the authority's key
  bool former = false;  ///< of a client: all but its newest credentials
};

/// Adds `secure` and its verbs, which fill `options`, where one of them was called.
void add_secure_verbs(CLI::App& app, std::optional<SecureOptions>& options);

}  // namespace kinship::app
