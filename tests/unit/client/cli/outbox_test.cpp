#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "client/cli/commands.hpp"
#include "client/link/outbox.hpp"
#include "proto/types/exit_code.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::cli::outbox_test {
namespace {

class OutboxCommands : public testing::Test {
 protected:
  Uuid set_aside() {
    const Attempt attempt = values_.attempt(5);
    outbox_.add(attempt);
    outbox_.set_aside(attempt.report_uuid, "violates \"hand\" [23514]");
    return attempt.report_uuid;
  }
  int run_outbox(std::vector<std::string> words) {
    words.insert(words.begin(), {"kinship", "outbox"});
    words.insert(words.end(), {"--outbox", folder_.path().string()});
    std::vector<const char*> argv;
    for (const std::string& word : words)
      argv.push_back(word.c_str());
    out_.str("");
    err_.str("");
    return run(static_cast<int>(argv.size()), argv.data(), out_, err_);
  }

  test::TemporaryDirectory folder_;
  test::RandomValues values_{39};
  link::Outbox outbox_{folder_.path()};
  std::ostringstream out_, err_;
};

TEST_F(OutboxCommands, ListNamesWhatWaitsAndWhy) {
  const Uuid aside = set_aside();
  const std::string folder = Uuid::random().text() + ".json";
  std::filesystem::create_directory(folder_.path() / "pending" / folder);
  EXPECT_EQ(run_outbox({"list"}), kDone) << err_.str();
  for (const std::string& word : {"set_aside/" + aside.text(), "pending/" + folder,
                                  std::string("is no regular file"), std::string("[23514]")})
    EXPECT_NE(out_.str().find(word), std::string::npos) << word << " in\n" << out_.str();
  EXPECT_EQ(run_outbox({"list", "--json"}), kDone);
  EXPECT_NE(out_.str().find(R"({"file":"set_aside/)" + aside.text() +
                            R"(.json","state":"set aside","why":"violates \"hand\" [23514]"})"),
            std::string::npos)
      << out_.str();
}

TEST_F(OutboxCommands, ResendOffersAllOrTheNamedOnesAgain) {
  const Uuid first = set_aside(), second = set_aside();
  EXPECT_EQ(run_outbox({"resend", first.text().substr(0, 8)}), kDone) << err_.str();
  EXPECT_EQ(outbox_.pending(), std::vector{first});
  EXPECT_EQ(outbox_.reports_set_aside(), std::vector{second});
  EXPECT_EQ(run_outbox({"resend", first.text()}), kNotFound);
  EXPECT_EQ(run_outbox({"resend", "no-uuid"}), kWrongUsage);
  set_aside();
  EXPECT_EQ(run_outbox({"resend"}), kDone);
  EXPECT_NE(out_.str().find("2 reports pending again"), std::string::npos) << out_.str();
  EXPECT_EQ(outbox_.pending_count(), 3U);
}

TEST_F(OutboxCommands, RejectedOnesAreOfferedAgainOrDeletedOnceThatIsConfirmed) {
  const Attempt attempt = values_.attempt(5), other = values_.attempt(5);
  for (const Attempt& each : {attempt, other}) {
    outbox_.add(each);
    outbox_.reject(each.report_uuid, "'arm_7' may not register it");
  }
  EXPECT_EQ(run_outbox({"resend"}), kDone);
  EXPECT_EQ(outbox_.pending_count(), 0U) << "only what is set aside";
  EXPECT_EQ(run_outbox({"drop", other.report_uuid.text()}), kDone);
  EXPECT_NE(out_.str().find("1 report would be deleted"), std::string::npos) << out_.str();
  EXPECT_EQ(outbox_.reports_rejected().size(), 2U);
  EXPECT_EQ(run_outbox({"drop", Uuid::random().text()}), kNotFound);
  EXPECT_EQ(run_outbox({"drop", other.report_uuid.text(), "--yes"}), kDone);
  EXPECT_EQ(outbox_.reports_rejected(), std::vector{attempt.report_uuid});
  EXPECT_EQ(run_outbox({"resend", "--rejected"}), kDone);
  EXPECT_EQ(outbox_.pending(), std::vector{attempt.report_uuid});
}

TEST_F(OutboxCommands, ALookMakesNoOutbox) {
  const std::filesystem::path none = folder_.path() / "none";
  std::ostringstream out, err;
  const std::string text = none.string();
  const char* const argv[] = {"kinship", "outbox", "list", "--outbox", text.c_str()};
  EXPECT_EQ(run(5, argv, out, err), kNotFound);
  EXPECT_FALSE(std::filesystem::exists(none));
  EXPECT_EQ(run_outbox({"list"}), kDone) << err_.str();
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "set_aside")) << "nothing was set aside";
}

}  // namespace
}  // namespace kinship::cli::outbox_test
