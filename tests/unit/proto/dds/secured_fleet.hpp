#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "proto/dds/requester.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// A domain with security, with a server (echo_server) in a process of its own and the credentials
/// of client "alice", an operator for the tasks shelf_*.
class SecuredFleet : public testing::Test {
 protected:
  using AdminRequester = dds::Requester<codec::AdminConversation>;
  using milliseconds = std::chrono::milliseconds;

  static std::chrono::sys_seconds now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  }

  /// What the server says, or the error's message.
  static std::string ask(AdminRequester& requester, const std::string& text,
                         milliseconds patience = std::chrono::seconds(10)) {
    AdminRequest request;
    request.argument = text;
    const auto reply = requester.call(request, AdminRequester::Clock::now() + patience);
    if (!reply)
      return reply.error().message;
    return reply->rows.empty() ? reply->message : reply->rows.front();
  }

  security::SecurityFolder init(const std::string& name) const {
    return security::SecurityFolder::init(directory_ / name.c_str(), security::kDefaultDays, now());
  }
  std::filesystem::path add(const security::SecurityFolder& folder,
                            const security::NewClient& client, const std::string& out) const {
    folder.add(client, directory_ / out.c_str(), now());
    return directory_ / out.c_str();
  }
  dds::Participant join(const std::filesystem::path& credentials) const {
    return dds::Participant({.domain = domain_.number(), .security = credentials});
  }
  std::string ask_as(const std::filesystem::path& credentials, const std::string& text,
                     milliseconds patience = std::chrono::seconds(10)) const {
    const dds::Participant participant = join(credentials);
    AdminRequester requester(participant, Uuid::random());
    return ask(requester, text, patience);
  }
  std::string domain() const { return std::to_string(domain_.number()); }

  const TemporaryDirectory directory_;
  const ReservedDomain domain_;
  const security::SecurityFolder fleet_ = init("fleet");
  const std::filesystem::path alice_ =
      add(fleet_, {.name = "alice", .role = AccessRole::Operator, .tasks = {"shelf_*"}}, "alice");
  ChildProcess server_{{KINSHIP_ECHO_SERVER, domain(), directory_ / "fleet"}};
};

}  // namespace kinship::test
