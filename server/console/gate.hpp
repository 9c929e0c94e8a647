#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/http/address.hpp"
#include "server/http/message.hpp"

namespace kinship::console {

/// Decides which requests the console answers: those that carry its token, once in a link and then
/// in a cookie, and of those that change something only what its own pages send. May be shared
/// between threads.
class Gate {
 public:
  /// \param token  letters and digits.
  /// \param port   names the cookie: browsers give one host's cookies to all its ports.
  Gate(std::string token, std::uint16_t port, bool has_tls);

  /// The reply to a request that goes no further; nothing for one that may.
  std::optional<http::Reply> stop(const http::Request& request) const;

  /// The link that lets a browser in. \param url  of the port.
  std::string link(std::string_view url) const;

 private:
  bool is_token(std::string_view text) const;
  http::Reply let_in(const http::Request& request) const;
  bool is_of_other_page(const http::Request& request) const;

  const std::string token_, cookie_;
  const bool has_tls_;
};

/// A reply with the fields that all of the console's replies carry: its pages load only what this
/// port serves, stand in no frame, and tell other sites nothing.
http::Reply guarded(http::Reply reply);

}  // namespace kinship::console
