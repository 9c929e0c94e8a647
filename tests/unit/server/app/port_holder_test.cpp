#include "server/app/port_holder.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace kinship::app {
namespace {

/// A socket of this process at a port that the system chose.
class OpenPort {
 public:
  explicit OpenPort(int family) : socket_(socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in6 address{};  // the larger of the two; the port lies at the same place
    address.sin6_family = static_cast<sa_family_t>(family);
    socklen_t size = family == AF_INET ? sizeof(sockaddr_in) : sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    is_open_ = bind(socket_, generic, size) == 0 && getsockname(socket_, generic, &size) == 0;
    port_ = ntohs(address.sin6_port);
  }
  OpenPort(const OpenPort&) = delete;
  OpenPort& operator=(const OpenPort&) = delete;
  ~OpenPort() { close(socket_); }

  bool is_open() const noexcept { return is_open_; }
  std::uint16_t port() const noexcept { return port_; }
  std::uint64_t inode() const {
    struct stat status {};
    fstat(socket_, &status);
    return status.st_ino;
  }

 private:
  int socket_;
  bool is_open_ = false;
  std::uint16_t port_ = 0;
};

void expect_found(const OpenPort& open) {
  const auto holder = find_port_holder(open.port());
  ASSERT_TRUE(holder);
  EXPECT_EQ(holder->inode, open.inode());
  EXPECT_EQ(holder->user, getuid());
  EXPECT_EQ(holder->process, getpid());
  EXPECT_EQ(holder->program, "unit_app");
}

TEST(PortHolder, IsTheProcessWithTheSocket) { expect_found(OpenPort(AF_INET)); }

TEST(PortHolder, IsFoundOverIpv6Too) {
  const OpenPort open(AF_INET6);
  if (!open.is_open())
    GTEST_SKIP() << "no IPv6 here";
  expect_found(open);
}

TEST(PortHolder, NobodyHasAPortThatWasGivenBack) {
  std::uint16_t port = 0;
  for (int i = 0; i < 20; ++i) {  // the system may give the same one to somebody else
    port = OpenPort(AF_INET).port();
    if (!find_port_holder(port))
      return;
  }
  FAIL() << "port " << port;
}

}  // namespace
}  // namespace kinship::app
