#include "tests/support/reserved_domain.hpp"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "tests/support/own_network.hpp"

namespace kinship::test {
namespace {

constexpr std::uint32_t kDomains = ReservedDomain::kLast - ReservedDomain::kFirst + 1;

// Before main(): no thread runs yet that would stay in the network outside.
[[maybe_unused]] const bool kIsInOwnNetwork = enter_own_network();

/// Address of the claim on a domain: a name, not a file. It is known exactly where the ports are,
/// in this network namespace, and is free again when its holder ends, however it ends.
class ClaimAddress {
 public:
  explicit ClaimAddress(std::uint32_t domain) {
    const std::string name = "kinship-test-domain-" + std::to_string(domain);
    address_.sun_family = AF_UNIX;
    std::memcpy(address_.sun_path + 1, name.data(), name.size());  // begins with 0: no file
    size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address_); }
  socklen_t size() const noexcept { return size_; }

 private:
  sockaddr_un address_{};
  socklen_t size_ = 0;
};

int open_socket(int family, int type) {
  const int made = socket(family, type | SOCK_CLOEXEC, 0);
  if (made < 0)
    throw std::system_error(errno, std::system_category(), "socket");
  return made;
}

/// \return a socket that holds the claim; -1 if somebody else does.
int claim(std::uint32_t domain) {
  const ClaimAddress address(domain);
  const int holder = open_socket(AF_UNIX, SOCK_STREAM);
  if (bind(holder, address.get(), address.size()) == 0 && listen(holder, SOMAXCONN) == 0)
    return holder;
  close(holder);
  return -1;
}

/// Waits until one of the claims is given back: who holds one never answers, and a connection to it
/// ends with it.
void wait_for_release(const std::vector<std::uint32_t>& claimed) {
  std::vector<pollfd> connections;
  bool is_released = false;
  for (const std::uint32_t domain : claimed) {
    const ClaimAddress address(domain);
    connections.push_back(
        {.fd = open_socket(AF_UNIX, SOCK_STREAM), .events = POLLIN, .revents = 0});
    is_released |= connect(connections.back().fd, address.get(), address.size()) != 0;
  }
  if (!is_released)
    poll(connections.data(), connections.size(), -1);
  for (const pollfd& connection : connections)
    close(connection.fd);
}

bool is_free(std::uint16_t port) {
  const int probe = open_socket(AF_INET, SOCK_DGRAM);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const bool is_bound =
      bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  close(probe);
  return is_bound;
}

/// Whether nobody has the ports of the domain's server: discovery and data.
bool has_free_ports(std::uint32_t domain) {
  const auto discovery = static_cast<std::uint16_t>(7400 + 250 * domain + 10);
  return is_free(discovery) && is_free(static_cast<std::uint16_t>(discovery + 1));
}

}  // namespace

ReservedDomain::ReservedDomain() {
  const auto start = static_cast<std::uint32_t>(getpid());
  while (true) {
    std::vector<std::uint32_t> claimed;
    for (std::uint32_t i = 0; i < kDomains; ++i) {
      number_ = kFirst + (start + i) % kDomains;
      claim_ = claim(number_);
      if (claim_ >= 0 && has_free_ports(number_))
        return;
      if (claim_ >= 0)
        close(claim_);
      else
        claimed.push_back(number_);
    }
    if (claimed.empty())
      throw std::runtime_error("ports of all domains from " + std::to_string(kFirst) + " to " +
                               std::to_string(kLast) + " are taken by other software");
    wait_for_release(claimed);
  }
}

ReservedDomain::~ReservedDomain() { close(claim_); }

}  // namespace kinship::test
