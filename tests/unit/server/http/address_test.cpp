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

}  // namespace
}  // namespace kinship::http::address_test
