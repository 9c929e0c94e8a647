#include "server/app/serve.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "proto/types/failure.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app::serve_test {
namespace {

TEST(Serve, WhoCannotJoinTheDomainLeavesNoStoreBehind) {
  const test::TemporaryDirectory directory;
  ServerOptions options;
  options.store = directory / "fleet.db";
  options.network_interface = "no_such_interface";
  options.log_level = "off";
  std::ostringstream out;
  EXPECT_THROW(serve(options, out), Failure);
  EXPECT_TRUE(std::filesystem::is_empty(options.store.parent_path()));
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace kinship::app::serve_test
