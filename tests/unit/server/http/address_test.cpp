#include "server/http/address.hpp"

#include <gtest/gtest.h>

namespace kinship::http::address_test {
namespace {

TEST(Address, IsAnAddressAndAPort) {
  const auto text = [](const char* from) { return to_text(read_address(from).value()); };
  for (const char* const good : {"127.0.0.1:9464", "0.0.0.0:0", "[::1]:65535"})
    EXPECT_EQ(text(good), good);
  for (const char* const bad :
       {"", "9464", ":9464", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1",
        "127.0.0.1:94 ", "localhost:9464", "::1:9464", "[::1]", "[127.0.0.1]:1", "1.2.3:4"}) {
    const auto read = read_address(bad);
    ASSERT_FALSE(read) << bad;
    EXPECT_TRUE(read.error().message.starts_with("'" + std::string(bad) + "' is not an address"));
  }
}

TEST(Address, IsLoopbackWhereOnlyThisMachineReachesIt) {
  for (const char* const own : {"127.0.0.1:1", "127.9.9.9:1", "[::1]:1"})
    EXPECT_TRUE(is_loopback(read_address(own).value())) << own;
  for (const char* const open : {"0.0.0.0:1", "[::]:1", "192.0.2.1:1", "12.7.0.1:1"})
    EXPECT_FALSE(is_loopback(read_address(open).value())) << open;
}

}  // namespace
}  // namespace kinship::http::address_test
