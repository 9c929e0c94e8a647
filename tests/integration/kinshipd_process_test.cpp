// kinshipd as a process: how it starts, refuses to start, and ends.

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::kinshipd_process_test {
namespace {

int discovery_port(std::uint32_t domain) { return static_cast<int>(7400 + 250 * domain + 10); }

/// Other software: has a UDP port, says nothing.
class PortTaker {
 public:
  explicit PortTaker(int port) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    has_it_ = bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  PortTaker(const PortTaker&) = delete;
  PortTaker& operator=(const PortTaker&) = delete;
  ~PortTaker() { close(socket_); }

  bool has_it() const noexcept { return has_it_; }

 private:
  int socket_;
  bool has_it_ = false;
};

class KinshipdProcess : public testing::Test {
 protected:
  test::ServerProcess::Options options(const char* store = "fleet.db") const {
    return {.store = directory_ / store, .domain = domain_.number()};
  }
  /// Exit code of a kinshipd that is expected to end by itself; its messages go to `error_`.
  int run(const std::vector<std::string>& arguments) {
    const test::Answer answer = test::run_to_end("kinshipd", arguments);
    output_ = answer.out;
    error_ = answer.err;
    return answer.code;
  }

  int run_on(std::uint32_t domain, const char* store = "fleet.db") {
    return run({"--store", (directory_ / store).string(), "--domain", std::to_string(domain)});
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::string output_, error_;
};

TEST_F(KinshipdProcess, SaysWhenItServesAndWhere) {
  test::ServerProcess server(options());
  EXPECT_EQ(server.ready_line(), "ready domain=" + std::to_string(domain_.number()) +
                                     " store=" + (directory_ / "fleet.db").string());
}

TEST_F(KinshipdProcess, EndsWellOnSigtermAndSigint) {
  test::ServerProcess server(options());
  EXPECT_EQ(server.terminate(), 0);
  test::Program again(
      "kinshipd",
      {"--store", (directory_ / "fleet.db").string(), "--domain", std::to_string(domain_.number())},
      directory_ / "error");
  again.read_line();
  again.signal(SIGINT);
  EXPECT_EQ(again.wait(), 0);
}

TEST_F(KinshipdProcess, TheSecondOneOnAStoreFailsAndSaysWhy) {
  const test::ServerProcess server(options());
  const test::ReservedDomain other;
  EXPECT_EQ(run_on(other.number()), 1);
  EXPECT_EQ(output_, "");
  EXPECT_NE(error_.find("is open in another server"), std::string::npos) << error_;
}

TEST_F(KinshipdProcess, TheSecondOneOnADomainFailsAndSaysWhy) {
  const test::ServerProcess server(options());
  EXPECT_EQ(run_on(domain_.number(), "other.db"), 1);
  EXPECT_EQ(output_, "");
  EXPECT_NE(error_.find("domain " + std::to_string(domain_.number()) + ": another kinshipd has it"),
            std::string::npos)
      << error_;
  EXPECT_NE(error_.find("process " + std::to_string(server.pid())), std::string::npos) << error_;
  EXPECT_NE(error_.find("store '" + (directory_ / "fleet.db").string() + "'"), std::string::npos)
      << error_;
}

TEST_F(KinshipdProcess, OneThatDoesNotAnswerIsStillAKinshipd) {
  test::ServerProcess server(options());
  ASSERT_EQ(kill(server.pid(), SIGSTOP), 0);
  EXPECT_EQ(run_on(domain_.number(), "other.db"), 1);
  EXPECT_NE(error_.find("another kinshipd has it"), std::string::npos) << error_;
  EXPECT_NE(error_.find("does not answer"), std::string::npos) << error_;
}

/// Other software at all places that a server may have in a domain, at their first or second port.
class PlaceTaker {
 public:
  PlaceTaker(std::uint32_t domain, int offset) {
    for (int place = 0; place < 8; ++place)
      takers_.push_back(std::make_unique<PortTaker>(discovery_port(domain) + 2 * place + offset));
  }

 private:
  std::vector<std::unique_ptr<PortTaker>> takers_;
};

TEST_F(KinshipdProcess, WhereOtherSoftwareHasTheFirstPlaceItTakesTheNextAndIsFound) {
  for (const int offset : {0, 1}) {
    const PortTaker other(discovery_port(domain_.number()) + offset);
    test::ServerProcess server(options());
    const test::Answer status =
        test::run_to_end("kinship", {"status", "--domain", std::to_string(domain_.number())});
    EXPECT_EQ(status.code, 0) << status.err;
    EXPECT_EQ(run_on(domain_.number(), "other.db"), 1) << "a domain has one server";
    EXPECT_NE(error_.find("another kinshipd has it"), std::string::npos) << error_;
    EXPECT_EQ(server.terminate(), 0);
  }
}

TEST_F(KinshipdProcess, AServerThatCameFirstIsSeenWhereItsFirstPlaceIsFreeAgain) {
  auto other = std::make_unique<PortTaker>(discovery_port(domain_.number()));
  const test::ServerProcess server(options());
  other.reset();
  EXPECT_EQ(run_on(domain_.number(), "other.db"), 1);
  EXPECT_NE(error_.find("another kinshipd has it"), std::string::npos) << error_;
}

TEST_F(KinshipdProcess, WhoHasAllPlacesOfTheDomainAndIsNoKinshipdIsNamed) {
  for (const int offset : {0, 1}) {
    const PlaceTaker others(domain_.number(), offset);
    EXPECT_EQ(run_on(domain_.number()), 1);
    const std::string taken = "domain " + std::to_string(domain_.number()) + ": UDP port " +
                              std::to_string(discovery_port(domain_.number()) + offset) +
                              " is taken by 'integration_kin' (process " +
                              std::to_string(getpid()) + ")";
    EXPECT_NE(error_.find(taken), std::string::npos) << error_;
    EXPECT_NE(error_.find("; take another domain (--domain N)"), std::string::npos) << error_;
    EXPECT_EQ(error_.find("another kinshipd"), std::string::npos) << error_;
  }
  EXPECT_FALSE(std::filesystem::exists(directory_ / "fleet.db"));
}

TEST_F(KinshipdProcess, ADomainInTheRangeOfEphemeralPortsIsAdvisedAgainstWhenItsPortsAreTaken) {
  constexpr std::uint32_t kDomain = 119;
  std::uint32_t first = 0, last = 0;
  std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> first >> last;
  if (first != 32768 || last < 60999)
    GTEST_SKIP() << "ephemeral ports from " << first << " to " << last;
  const PlaceTaker others(kDomain, 0);  // or somebody else has them already
  EXPECT_EQ(run_on(kDomain), 1);
  EXPECT_NE(error_.find("domain 119: UDP port 37160 is taken by "), std::string::npos) << error_;
  EXPECT_NE(error_.find("take a domain from 0 to 101"), std::string::npos) << error_;
}

TEST_F(KinshipdProcess, ADomainInTheRangeOfEphemeralPortsIsServedWhileItsPortsAreFree) {
  std::uint32_t domain = 102;
  while (domain < 230 && !(PortTaker(discovery_port(domain)).has_it() &&
                           PortTaker(discovery_port(domain) + 1).has_it()))
    ++domain;
  const test::ServerProcess server({.store = directory_ / "fleet.db", .domain = domain});
  EXPECT_EQ(test::read_text(directory_ / "fleet.db.log").find("ports"), std::string::npos);
}

/// What systemd would hear of a service.
class ServiceManager {
 public:
  explicit ServiceManager(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot bind " + path.string());
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~ServiceManager() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(socket_);
  }
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  std::string receive() const {
    char text[64] = {};
    const ssize_t size = recv(socket_, text, sizeof text, 0);
    return std::string(text, size > 0 ? static_cast<std::size_t>(size) : 0);
  }

 private:
  int socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

TEST_F(KinshipdProcess, TellsTheServiceManagerWhenItServesAndWhenItStops) {
  const ServiceManager manager(directory_ / "notify");
  test::ServerProcess server(options());
  EXPECT_EQ(manager.receive(), "READY=1");
  EXPECT_EQ(server.terminate(), 0);
  EXPECT_EQ(manager.receive(), "STOPPING=1");
}

TEST_F(KinshipdProcess, TellsTheWatchdogThatItServesAsLongAsItDoes) {
  const ServiceManager manager(directory_ / "notify");
  setenv("WATCHDOG_USEC", "100000", 1);
  test::ServerProcess server(options());
  EXPECT_EQ(manager.receive(), "READY=1");
  using Clock = std::chrono::steady_clock;
  EXPECT_EQ(manager.receive(), "WATCHDOG=1");
  const Clock::time_point first = Clock::now();
  constexpr int kBeats = 4;
  for (int i = 0; i < kBeats; ++i)
    EXPECT_EQ(manager.receive(), "WATCHDOG=1");  // blocks for ever if it does not come
  EXPECT_GE(Clock::now() - first, std::chrono::milliseconds(150));  // of 4 * 50 ms: no busy loop
  EXPECT_EQ(server.terminate(), 0);
}

}  // namespace
}  // namespace kinship::kinshipd_process_test
