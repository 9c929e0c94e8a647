// kinshipd as a process: how it starts, refuses to start, and ends.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::kinshipd_process_test {
namespace {

class KinshipdProcess : public testing::Test {
 protected:
  test::ServerProcess::Options options(const char* store = "fleet.db") const {
    return {.store = directory_ / store, .domain = domain_.number(), .arguments = {}};
  }
  /// Exit code of a kinshipd that is expected to end by itself; its messages go to `error_`.
  int run(const std::vector<std::string>& arguments) {
    test::Program program("kinshipd", arguments, directory_ / "error");
    output_ = program.read_all();
    const int code = program.wait();
    error_ = test::read_text(directory_ / "error");
    return code;
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
  EXPECT_EQ(run({"--store", (directory_ / "fleet.db").string(), "--domain",
                 std::to_string(other.number())}),
            1);
  EXPECT_EQ(output_, "");
  EXPECT_NE(error_.find("is open in another server"), std::string::npos) << error_;
}

TEST_F(KinshipdProcess, TheSecondOneOnADomainFailsAndSaysWhy) {
  const test::ServerProcess server(options());
  EXPECT_EQ(run({"--store", (directory_ / "other.db").string(), "--domain",
                 std::to_string(domain_.number())}),
            1);
  EXPECT_EQ(output_, "");
  EXPECT_NE(error_.find("is another server running?"), std::string::npos) << error_;
}

TEST_F(KinshipdProcess, WhatIsNoStoreIsRefused) {
  std::ofstream(directory_ / "notes.txt") << "not a database, but long enough to look like one";
  EXPECT_EQ(run({"--store", (directory_ / "notes.txt").string(), "--domain",
                 std::to_string(domain_.number())}),
            1);
  EXPECT_NE(error_.find("notes.txt': is no SQLite database"), std::string::npos) << error_;
  EXPECT_FALSE(std::filesystem::exists(directory_ / "notes.txt.lock"));
}

TEST_F(KinshipdProcess, WrongUsageIsExitCodeTwoAndHelpIsZero) {
  EXPECT_EQ(run({"--domain", "1000"}), 2);
  EXPECT_EQ(run({"--what"}), 2);
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_NE(output_.find("Examples:"), std::string::npos);
}

TEST_F(KinshipdProcess, TellsTheServiceManagerWhenItServesAndWhenItStops) {
  const std::filesystem::path path = directory_ / "notify";
  const int notify = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(bind(notify, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(setenv("NOTIFY_SOCKET", path.c_str(), 1), 0);
  test::ServerProcess server(options());
  ASSERT_EQ(unsetenv("NOTIFY_SOCKET"), 0);
  const auto receive = [notify] {
    char text[64] = {};
    const ssize_t size = recv(notify, text, sizeof text, 0);
    return std::string(text, size > 0 ? static_cast<std::size_t>(size) : 0);
  };
  EXPECT_EQ(receive(), "READY=1");
  EXPECT_EQ(server.terminate(), 0);
  EXPECT_EQ(receive(), "STOPPING=1");
  close(notify);
}

}  // namespace
}  // namespace kinship::kinshipd_process_test
