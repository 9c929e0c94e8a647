#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/raw_conversation.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::test {

/// A kinshipd that knows the panda, and ways to see that nonsense left it as it was.
class BadInput : public testing::Test {
 protected:
  BadInput()
      : server_({.store = directory_ / "fleet.db", .domain = domain_.number()}),
        client_({.domain = domain_.number(),
                 .outbox = directory_ / "outbox",
                 .timeout = std::chrono::seconds(60)}),
        participant_({.domain = domain_.number()}) {
    panda_ = client_.register_robot(model_description("panda")).value_or_throw().robot;
  }

  ServerStatus status() {
    return json::row_from_json<ServerStatus>(client_.admin({}).value_or_throw().rows.at(0))
        .value_or_throw();
  }

  /// It answers, and has the panda and nothing else.
  void expect_untouched() {
    const ServerStatus now = status();
    EXPECT_EQ(now.robots, 1U);
    EXPECT_EQ(now.tasks, 0U);
    EXPECT_EQ(now.attempts, 0U);
    EXPECT_EQ(now.paths, 0U);
    EXPECT_EQ(now.distributions, 0U);
    EXPECT_EQ(server_.terminate(), 0) << "a crash, or a sanitizer's finding at its end";
  }

  /// The message names thing, value and limit.
  static void expect_words(const std::string& message, const std::vector<std::string>& words) {
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos)
          << "'" << word << "' is not in '" << message << "'";
  }

  ReservedDomain domain_;
  TemporaryDirectory directory_;
  ServerProcess server_;
  link::Client client_;
  dds::Participant participant_;
  Digest panda_;
};

}  // namespace kinship::test
