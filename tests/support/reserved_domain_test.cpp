#include "tests/support/reserved_domain.hpp"

#include <gtest/gtest.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/own_network.hpp"

namespace kinship::test {
namespace {

constexpr std::uint32_t kFirst = ReservedDomain::kFirst, kLast = ReservedDomain::kLast;

TEST(ReservedDomain, PortsLieBelowThoseThatAreGivenToWhoeverAsksForAny) {
  EXPECT_LT(7400 + 250 * kLast + 11, 32768U);
}

TEST(ReservedDomain, NoTwoAreTheSame) {
  const ReservedDomain one, two, three;
  EXPECT_EQ(std::set({one.number(), two.number(), three.number()}).size(), 3U);
}

/// Alone in a network: may take every domain without disturbing other tests.
class OwnNetwork : public testing::Test {
 protected:
  void SetUp() override {
    if (!enter_own_network())
      GTEST_SKIP() << "a network of its own is not permitted here";
  }
  void TearDown() override {
    for (const int socket : sockets_)
      close(socket);
  }

  void take_port(std::uint32_t port) {
    sockets_.push_back(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    ASSERT_EQ(bind(sockets_.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }

 private:
  std::vector<int> sockets_;
};

TEST_F(OwnNetwork, HoldsTheLoopbackInterfaceOnly) {
  struct if_nameindex* const all = if_nameindex();
  std::vector<std::string> names;
  for (const struct if_nameindex* each = all; each->if_index != 0; ++each)
    names.emplace_back(each->if_name);
  if_freenameindex(all);
  EXPECT_EQ(names, std::vector<std::string>{"lo"});
}

TEST_F(OwnNetwork, ADomainWithATakenPortIsPassedOver) {
  constexpr std::uint32_t kLeft = kFirst + 7;
  for (std::uint32_t domain = kFirst; domain <= kLast; ++domain)
    if (domain != kLeft)
      take_port(7400 + 250 * domain + (domain % 2 == 0 ? 10 : 11));  // discovery or data
  EXPECT_EQ(ReservedDomain().number(), kLeft);
  take_port(7400 + 250 * kLeft + 10);
  EXPECT_THROW(ReservedDomain(), std::runtime_error);
}

TEST_F(OwnNetwork, WhenAllAreReservedTheFirstThatIsGivenBackIsTaken) {
  std::vector<std::unique_ptr<ReservedDomain>> all;
  for (std::uint32_t domain = kFirst; domain <= kLast; ++domain)
    all.push_back(std::make_unique<ReservedDomain>());
  auto late = std::async(std::launch::async, [] { return ReservedDomain().number(); });
  EXPECT_EQ(late.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  const std::uint32_t number = all[5]->number();
  all[5].reset();
  EXPECT_EQ(late.get(), number);
}

}  // namespace
}  // namespace kinship::test
