#include "server/http/address.hpp"

#include <arpa/inet.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>

namespace kinship::http {
namespace {

bool is_address(int family, const std::string& text) {
  in6_addr address{};  // the larger of the two
  return inet_pton(family, text.c_str(), &address) == 1;
}

bool are_equal(const std::string& name, const std::string& other) {
  return strcasecmp(name.c_str(), other.c_str()) == 0;
}

}  // namespace

Result<Address> read_address(std::string_view text) {
  const Error wrong = invalid_input("'" + std::string(text) +
                                    "' is not an address and a port, such as 127.0.0.1:9464, "
                                    "[::1]:9464, or 0.0.0.0:9464 for all networks");
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos)
    return wrong;
  Address read;
  const char* const end = text.data() + text.size();
  const auto [rest, mistake] = std::from_chars(text.data() + colon + 1, end, read.port);
  if (mistake != std::errc{} || rest != end)
    return wrong;
  const std::string_view host = text.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) {
    read.address = host.substr(1, host.size() - 2);
    return is_address(AF_INET6, read.address) ? Result<Address>(read) : wrong;
  }
  read.address = host;
  return is_address(AF_INET, read.address) ? Result<Address>(read) : wrong;
}

std::string name_of_this_machine() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

bool is_loopback(const Address& address) {
  return address.address.starts_with("127.") || address.address == "::1";
}

bool is_served_host(std::string_view host, const std::vector<std::string>& names) {
  if (host.starts_with('['))
    return host.find(']') != std::string_view::npos &&
           is_address(AF_INET6, std::string(host.substr(1, host.find(']') - 1)));
  const std::string name(host.substr(0, host.rfind(':')));
  return is_address(AF_INET, name) || are_equal(name, "localhost") ||
         are_equal(name, name_of_this_machine()) ||
         std::ranges::any_of(names, [&](const std::string& one) { return are_equal(name, one); });
}

std::string to_text(const Address& address) {
  const std::string port = ':' + std::to_string(address.port);
  return address.address.find(':') == std::string::npos ? address.address + port
                                                        : '[' + address.address + ']' + port;
}

}  // namespace kinship::http
