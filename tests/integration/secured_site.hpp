#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "proto/security/security_folder.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

/// What intruders of kinshipd are tried with: one server without security and one with it.
namespace kinship::test {

inline std::chrono::sys_seconds now_s() {
  return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// One kinshipd, and what is asked of it as who may everything. A process that has joined a domain
/// with security hears nobody in one without, so the open site comes first and goes before.
class Site {
 public:
  using seconds = std::chrono::seconds;

  /// \param fleet  its security folder; empty: none.
  /// \param admin  credentials of an admin; empty: none.
  Site(const std::filesystem::path& store, const std::filesystem::path& fleet,
       const std::filesystem::path& admin)
      : folder_(store.string() + ".site"),
        server_({.store = store,
                 .domain = domain_.number(),
                 .arguments = fleet.empty()
                                  ? std::vector<std::string>{}
                                  : std::vector<std::string>{"--security", fleet.string()}}),
        client_(std::make_unique<link::Client>(link::ClientOptions{.domain = domain_.number(),
                                                                   .security = admin,
                                                                   .outbox = folder_ / "outbox",
                                                                   .timeout = seconds(30)})),
        panda_(client_->register_robot(model_description("panda")).value_or_throw().robot) {}

  std::uint32_t domain() const { return domain_.number(); }
  const Digest& panda() const { return panda_; }
  link::Client& client() const { return *client_; }

  /// Reports of the panda for a task. \return the UUID of the last one.
  std::string report(const std::string& task, std::uint64_t count = 1) const {
    Attempt attempt;
    for (std::uint64_t i = 0; i < count; ++i)
      client_->report(attempt = panda_attempt(panda_, task, i));
    const auto left = client_->flush(seconds(30));
    EXPECT_EQ(left.pending + left.refused, 0U) << left.problem;
    return attempt.report_uuid.text();
  }

  /// The rows of a listing, one after another.
  std::string rows(AdminVerb verb) const {
    AdminRequest request;
    request.verb = verb;
    std::string text;
    for (const std::string& row : client_->admin(request).value_or_throw().rows)
      text += row + '\n';
    return text;
  }
  bool has(AdminVerb verb, const std::string& text) const {
    return rows(verb).find(text) != std::string::npos;
  }
  /// Whether it comes to that within some seconds.
  bool comes(AdminVerb verb, const std::string& text) const {
    const auto deadline = std::chrono::steady_clock::now() + seconds(30);
    while (std::chrono::steady_clock::now() < deadline)
      if (has(verb, text))
        return true;
    return false;
  }
  /// Whether a path of the task is there that is not retired.
  bool keeps_path(const std::string& task) const {
    std::istringstream paths(rows(AdminVerb::ListPaths));
    for (std::string path; std::getline(paths, path);)
      if (path.find("\"task\":\"" + task + '"') != std::string::npos &&
          path.find("\"retired_ms\":0,") != std::string::npos)
        return true;
    return false;
  }

  /// Whether it comes to that there is none within some seconds.
  bool loses_path(const std::string& task) const {
    const auto deadline = std::chrono::steady_clock::now() + seconds(30);
    while (std::chrono::steady_clock::now() < deadline)
      if (!keeps_path(task))
        return true;
    return false;
  }

  /// `kinship` as a process.
  Answer kinship(const std::filesystem::path& credentials, const std::string& line) const {
    return run_to_end(
        "kinship",
        words("--domain " + std::to_string(domain()) + " --timeout 30 " +
              (credentials.empty() ? "" : "--security " + credentials.string()) + ' ' + line));
  }

 private:
  std::filesystem::path folder_;
  ReservedDomain domain_;
  ServerProcess server_;
  std::unique_ptr<link::Client> client_;
  Digest panda_;
};

/// A fleet's security folder, and the credentials of "anna", an admin.
class SecuredSite : public testing::Test {
 protected:
  std::filesystem::path add(const security::NewClient& client) const {
    const std::filesystem::path out = folder_ / client.name.c_str();
    fleet_.add(client, out, now_s());
    return out;
  }
  Site open_site() const { return {folder_ / "open.db", {}, {}}; }
  Site secured_site() const { return {folder_ / "secured.db", folder_ / "fleet", anna_}; }

  const TemporaryDirectory folder_;
  const security::SecurityFolder fleet_ =
      security::SecurityFolder::init(folder_ / "fleet", security::kDefaultDays, now_s());
  const std::filesystem::path anna_ = add({.name = "anna", .role = AccessRole::Admin});
};

}  // namespace kinship::test
