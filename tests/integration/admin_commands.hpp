#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// What people do with `kinship`, as a process, against kinshipd as a process.
namespace kinship::admin_commands_test {

using std::chrono::seconds;

using test::Answer;

/// One kinshipd and its domain.
class Server {
 public:
  explicit Server(const std::filesystem::path& store, std::vector<std::string> arguments = {})
      : store_(store), arguments_(std::move(arguments)) {
    start();
  }

  void start() {
    process_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = store_, .domain = domain_.number(), .arguments = arguments_});
  }
  test::ServerProcess& process() { return *process_; }
  std::uint32_t domain() const { return domain_.number(); }

  /// Words of `kinship` for this server, from a line of them.
  std::vector<std::string> with_domain(const std::string& line,
                                       const std::string& timeout_s = "30") const {
    return test::words("--domain " + std::to_string(domain()) + " --timeout " + timeout_s + " " +
                       line);
  }
  Answer kinship(const std::string& line, const std::string& timeout_s = "30") const {
    return test::run_to_end("kinship", with_domain(line, timeout_s));
  }
  /// What must end with this code.
  Answer ends(int code, const std::string& line) const {
    Answer answer = kinship(line);
    EXPECT_EQ(answer.code, code) << line << ": " << answer.out << answer.err;
    return answer;
  }
  std::unique_ptr<link::Client> client(const std::filesystem::path& outbox) const {
    return std::make_unique<link::Client>(
        link::ClientOptions{.domain = domain_.number(), .outbox = outbox, .timeout = seconds(30)});
  }

 private:
  std::filesystem::path store_;
  std::vector<std::string> arguments_;
  test::ReservedDomain domain_;
  std::unique_ptr<test::ServerProcess> process_;
};

inline void expect_has(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
}

inline std::size_t count_lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

class AdminCommands : public testing::Test {
 protected:
  /// Six sweeps of a panda, and an attempt that did not get on; a UR10e that has done nothing.
  void teach(const Server& server) {
    const auto client = server.client(folder_ / "outbox");
    const auto register_model = [&](const std::string& name) {
      return client->register_robot(test::model_description(name)).value_or_throw().robot;
    };
    const Digest panda = register_model("panda");
    register_model("ur10e");
    for (std::uint64_t i = 0; i < 6; ++i) {
      attempts_.push_back(test::panda_attempt(panda, "sweep", i));
      client->report(attempts_.back());
    }
    Attempt unsolved = test::panda_attempt(panda, "sweep", 99);
    unsolved.record.outcome = Outcome::Timeout;
    unsolved.path.reset();
    client->report(unsolved);
    ASSERT_EQ(client->flush(seconds(60)).accepted, 7U);
  }
  /// The Panda's distribution, its stored ways and what was rehearsed, waited for.
  FetchReply fetch_rehearsed(const Server& server) const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = attempts_.front().robot;
    request.deadline = seconds(200);
    request.experience_bytes = kDefaultExperienceBytes;
    request.rehearsed = true;
    return server.client(folder_ / "other_outbox")->fetch(request).value_or_throw();
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }

  test::TemporaryDirectory folder_;
  std::vector<Attempt> attempts_;
  Server server_{folder_ / "store.db"};
};

}  // namespace kinship::admin_commands_test
