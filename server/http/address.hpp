#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/result.hpp"

namespace kinship::http {

/// Where a listener is bound.
struct Address {
  std::string address;     ///< IPv4 or IPv6, in numbers
  std::uint16_t port = 0;  ///< 0: one that is free
};

/// Reads 127.0.0.1:9464 or [::1]:9464. Host names are refused: their address may change.
Result<Address> read_address(std::string_view text);

std::string name_of_this_machine();

/// Whether only this machine reaches it.
bool is_loopback(const Address& address);

/// Whether a request for this host is answered: an address, localhost, this machine's name or one
/// of `names`. A page of another name, which was made to lead here, is not this server's.
/// \param host  as in a request's field Host, with or without a port.
bool is_served_host(std::string_view host, const std::vector<std::string>& names);

/// As in a URL: 127.0.0.1:9464, [::1]:9464.
std::string to_text(const Address& address);

}  // namespace kinship::http
