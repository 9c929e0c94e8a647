#include "client/link/host_name.hpp"

#include <netdb.h>
#include <unistd.h>

#include <array>
#include <memory>

namespace kinship::link {
namespace {

bool is_loopback(const std::string& host) {
  return host.starts_with("127.") || host == "localhost" || host == "::1";
}

}  // namespace

std::string why_unknown(const std::string& host) {
  if (is_loopback(host))
    return {};
  addrinfo* found = nullptr;
  const int code = getaddrinfo(host.c_str(), nullptr, nullptr, &found);
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  return code == 0 ? std::string() : gai_strerror(code);
}

bool is_this_machine(const std::string& host) {
  std::array<char, 256> name{};
  return is_loopback(host) ||
         (gethostname(name.data(), name.size() - 1) == 0 && host == name.data());
}

}  // namespace kinship::link
