#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kinship::store::postgres {

/// Whether a text names a PostgreSQL database: it begins with postgresql:// or postgres://.
bool is_connection_string(std::string_view text);

/// A connection string, taken apart by libpq. Only this object knows its passwords: messages use
/// description().
class ConnectionString {
 public:
  /// \throws Failure(InvalidInput), which does not repeat the text, if libpq cannot read it.
  explicit ConnectionString(const std::string& text);

  /// "postgresql://user@host:port,other:port/database", each host with the port that the string
  /// gives it; never a password, nor other parameters.
  const std::string& description() const noexcept { return description_; }

  /// libpq's keywords and values, with defaults of ours: time limits for connecting and for dead
  /// connections, and the encoding.
  const std::vector<std::pair<std::string, std::string>>& parameters() const noexcept {
    return parameters_;
  }

  /// A connection string for each of its hosts; itself if it has one.
  std::vector<ConnectionString> each_host() const;

  /// The same for hosts that take writes or not (target_session_attrs).
  ConnectionString to_any_role() const;

  /// The message without the passwords of this string.
  std::string without_secrets(std::string message) const;

 private:
  void describe();
  void set(std::string_view keyword, const std::string& value);
  void set_default(std::string_view keyword, std::string_view value);
  std::string value_of(std::string_view keyword) const;

  std::vector<std::pair<std::string, std::string>> parameters_;
  std::vector<std::string> secrets_;
  std::string description_;
};

}  // namespace kinship::store::postgres
