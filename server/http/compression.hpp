#pragma once

#include <string>
#include <string_view>

#include "server/http/message.hpp"

namespace kinship::http {

/// Whether a request's sender reads gzip, by its Accept-Encoding (RFC 9110, 12.5.3).
bool accepts_gzip(const Request& request);

enum class Effort {
  Fast,  ///< for what is sent once
  Good   ///< for what is kept
};

/// A text as gzip (RFC 1952). Equal texts, equal bytes.
/// \throws std::bad_alloc
std::string gzip(std::string_view text, Effort effort);

/// A reply whose body is `gzipped` instead, and says so. Its address has other replies for those
/// who do not read it: caches are told.
Reply with_gzip(Reply reply, std::string gzipped);

}  // namespace kinship::http
