#include "server/app/secure.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "proto/security/private_files.hpp"
#include "server/app/options.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app {
namespace {

/// kinshipd secure ..., as its main has it.
class SecureTest : public testing::Test {
 protected:
  int run(std::vector<std::string> words) {
    words.insert(words.begin(), {"kinshipd", "secure"});
    std::vector<const char*> arguments;
    for (const std::string& word : words)
      arguments.push_back(word.c_str());
    out_.str("");
    err_.str("");
    const Options options =
        parse_arguments(static_cast<int>(arguments.size()), arguments.data(), out_, err_);
    if (const int* const code = std::get_if<int>(&options))
      return *code;
    return run_secure(std::get<SecureOptions>(options), now_, out_, err_);
  }

  int add(const std::string& name, const std::string& role, const std::string& out) {
    return run(
        {"add", name, "--security", folder_, "--role", role, "--out", scratch_ / out.c_str()});
  }

  std::string out() const { return out_.str(); }
  std::string err() const { return err_.str(); }
  bool says(const std::string& words) const {
    return (out() + err()).find(words) != std::string::npos;
  }

  test::TemporaryDirectory scratch_;
  const std::string folder_ = scratch_ / "security";
  const std::chrono::sys_seconds now_ =
      std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(SecureTest, InitAddListRevoke) {
  ASSERT_EQ(run({"init", folder_}), kDone) << err();
  EXPECT_TRUE(says("kinshipd --security " + folder_));
  ASSERT_EQ(run({"add", "arm", "--security", folder_, "--role", "robot", "--task", "shelf_*",
                 "--task", "bin", "--robot", "ur5e", "--days", "20", "--out", scratch_ / "arm"}),
            kDone)
      << err();
  ASSERT_EQ(run({"add", "--task", "bin", "leg", "--security", folder_, "--role", "reader", "--out",
                 scratch_ / "leg"}),
            kDone)
      << "one value each, so that a name may follow: " << err();
  ASSERT_EQ(run({"list", "--security", folder_}), kDone);
  EXPECT_TRUE(says("shelf_*,bin;")) << out();
  EXPECT_TRUE(says("robots ur5e")) << out();
  std::istringstream lines(out());  // as tables of kinship: it fits a terminal
  for (std::string line; std::getline(lines, line) && line.find("authority since") != 0;)
    EXPECT_LE(line.size(), 80U) << line;
  EXPECT_TRUE(says("1 of them expire within 30 days")) << err();
  ASSERT_EQ(run({"revoke", "arm", "--security", folder_}), kDone) << err();
  ASSERT_EQ(run({"list", "--security", folder_, "--json"}), kDone);
  EXPECT_TRUE(says(R"("name":"arm","role":"robot","tasks":["shelf_*","bin"],"robots":["ur5e"],)"
                   R"("state":"revoked")"))
      << out();
}

TEST_F(SecureTest, NoKeyIsEverPrinted) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  std::string all = out() + err();
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  all += out() + err();
  ASSERT_EQ(run({"list", "--security", folder_, "--json"}), kDone);
  all += out() + err();
  const std::string key = security::read_file(scratch_ / "arm" / "key.pem");
  ASSERT_GT(key.size(), 100U);
  EXPECT_EQ(all.find("PRIVATE"), std::string::npos);
  EXPECT_EQ(all.find(key.substr(30, 40)), std::string::npos);
}

TEST_F(SecureTest, AMisspeltRoleIsToldWhatItMayHaveBeen) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  EXPECT_EQ(add("arm", "operater", "arm"), kWrongUsage);
  EXPECT_TRUE(says("did you mean 'operator'?")) << err();
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "arm"));
}

TEST_F(SecureTest, ErrorsNameTheThingAndHaveACode) {
  EXPECT_EQ(run({"list", "--security", folder_}), kNotFound);
  EXPECT_TRUE(says(folder_ + ": is no security folder")) << err();
  ASSERT_EQ(run({"init", folder_}), kDone);
  EXPECT_EQ(run({"init", folder_}), kFailed);
  EXPECT_TRUE(says(folder_ + ": is not empty")) << err();
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  EXPECT_EQ(add("arm", "admin", "arm2"), kFailed);
  EXPECT_TRUE(says("client 'arm': exists already")) << err();
  EXPECT_EQ(add("leg", "admin", "arm"), kFailed);
  EXPECT_TRUE(says("is not empty")) << err();
  EXPECT_EQ(add("server", "admin", "s"), kWrongUsage);
  EXPECT_EQ(run({"revoke", "foot", "--security", folder_}), kNotFound);
  EXPECT_TRUE(says("client 'foot': is not in")) << err();
  EXPECT_EQ(run({"add", "leg", "--security", folder_, "--role", "admin"}), kWrongUsage);
  EXPECT_TRUE(says("--out")) << err();
}

TEST_F(SecureTest, ARenewalSaysHowTheFormerCredentialsEnd) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  EXPECT_EQ(run({"revoke", "arm", "--former", "--security", folder_}), kFailed);
  EXPECT_TRUE(says("client 'arm': has its first credentials")) << err();
  ASSERT_EQ(run({"renew", "arm", "--security", folder_, "--out", scratch_ / "arm2"}), kDone);
  EXPECT_TRUE(says("those it has stay valid too")) << out();
  EXPECT_TRUE(says("kinshipd secure revoke arm --former")) << out();
  ASSERT_EQ(run({"revoke", "arm", "--former", "--security", folder_}), kDone) << err();
  EXPECT_TRUE(says("its newest credentials (2) are the only ones")) << out();
  ASSERT_EQ(run({"list", "--security", folder_, "--json"}), kDone);
  EXPECT_TRUE(says(R"("state":"valid")")) << out();
}

TEST_F(SecureTest, AnAuthorityIsNotRetiredOverClientsThatNeedIt) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  ASSERT_EQ(run({"renew-authority", "--security", folder_}), kDone) << err();
  EXPECT_TRUE(says("secure renew NAME")) << out();
  EXPECT_EQ(run({"retire-authority", "--security", folder_}), kFailed);
  EXPECT_TRUE(says("would shut out 1 clients: arm")) << err();
  ASSERT_EQ(run({"renew", "arm", "--security", folder_, "--out", scratch_ / "arm2"}), kDone);
  EXPECT_EQ(run({"retire-authority", "--security", folder_}), kDone) << err();
  EXPECT_TRUE(says("renew once more for arm:")) << out();
  EXPECT_EQ(run({"renew-server", "--security", folder_}), kDone) << err();
}

TEST_F(SecureTest, TheListTellsWhoTrustsARetiredAuthority) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  ASSERT_EQ(run({"renew-authority", "--security", folder_}), kDone) << err();
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  ASSERT_EQ(run({"retire-authority", "--security", folder_}), kDone) << err();
  ASSERT_EQ(run({"list", "--security", folder_}), kDone);
  EXPECT_TRUE(says("valid, trusts a")) << out();
  ASSERT_EQ(run({"renew", "arm", "--security", folder_, "--out", scratch_ / "arm2"}), kDone);
  ASSERT_EQ(run({"list", "--security", folder_}), kDone);
  EXPECT_FALSE(says("retired")) << out();
}

TEST_F(SecureTest, AnAuthorityWhoseKeyLeakedIsReplacedAtOnce) {
  ASSERT_EQ(run({"init", folder_}), kDone);
  ASSERT_EQ(add("arm", "robot", "arm"), kDone);
  ASSERT_EQ(run({"renew-authority", "--leaked", "--security", folder_}), kDone) << err();
  EXPECT_TRUE(says("the new authority is the only one")) << out();
  ASSERT_EQ(run({"list", "--security", folder_}), kDone);
  EXPECT_TRUE(says("valid, previous")) << out();
  EXPECT_EQ(run({"retire-authority", "--security", folder_}), kFailed) << "it is";
}

}  // namespace
}  // namespace kinship::app
