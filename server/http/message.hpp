#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::http {

/// A request that was read completely.
struct Request {
  std::string method = {};                        ///< GET
  std::string path = {};                          ///< as it came, without its query
  std::vector<std::string> parts = {};            ///< of the path, between its slashes, decoded
  std::map<std::string, std::string> query = {};  ///< decoded
  /// By names in lower case; values of one name are joined by ", ".
  std::map<std::string, std::string> fields = {};
  std::string body = {};

  const std::string* field(const std::string& name) const;  ///< null: it has none
  std::string query_value(const std::string& name) const;   ///< empty: it has none
};

/// Adds path, parts and query of a request's target.
/// \return the request; InvalidInput for a target that is no path or has a wrong escape.
Result<Request> with_target(Request request, std::string_view target);

/// The value of a cookie among those of a request; empty if it is not there.
std::string cookie_of(const Request& request, std::string_view name);

/// Sends the next part of a stream, from any thread. \return false once the stream has ended, also
/// because its reader was too slow: the part is lost then.
using Send = std::function<bool(const std::shared_ptr<const std::string>& part)>;

struct Reply {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body = {};
  std::vector<std::pair<std::string, std::string>> fields = {};  ///< besides type and length
  /// Not empty: in place of a body comes a stream, and this is called once it may be sent to, on
  /// the listener's thread.
  std::function<void(Send)> stream = {};
};

/// A line of text with its line feed.
Reply text_reply(unsigned status, std::string text);

/// Called once per request, now or later, from any thread; does nothing once the listener has
/// ended.
using Answer = std::function<void(Reply)>;

/// Called on the listener's thread, so it must not wait.
using Handler = std::function<void(const Request&, const Answer&)>;

}  // namespace kinship::http
