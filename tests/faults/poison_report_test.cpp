// A report that the database does not take, among others of its batch: it alone is set aside at the
// client, named, kept, and offered again once the administrator has mended the database.

#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "client/link/client.hpp"
#include "client/link/outbox.hpp"
#include "client/link/put_off_tries.hpp"
#include "proto/types/hex.hpp"
#include "tests/faults/served_store.hpp"

namespace kinship::poison_report_test {
namespace {

using test::ServedStore;

constexpr std::size_t kReports = 10;

class PoisonReport : public testing::Test {
 protected:
  /// Into the outbox of a client that is not there yet, so that they go as one batch.
  PoisonReport() {
    link::Outbox outbox(folder_);
    for (std::size_t i = 0; i < kReports; ++i) {
      const Attempt attempt = test::panda_attempt(store_.robot(), "sweep", i + 1);
      outbox.add(attempt);
      reports_.push_back(attempt.report_uuid);
    }
  }
  /// As the client would have counted them by now, of each report all tries but the last.
  void count_tries() const {
    std::ofstream file(folder_ / "put_off");
    for (const Uuid& report : reports_)
      file << report.text() << ' ' << link::SetAsideRule::kTries - 1 << ' '
           << std::chrono::milliseconds(link::SetAsideRule::kAge).count() << " 1\n";
  }
  link::Client::OutboxState deliver() const {
    link::Client client({.domain = store_.cell().domain(), .outbox = folder_});
    return client.flush(test::Cell::kEnough);
  }
  test::Answer outbox_command(const std::string& verb) const {
    return store_.cell().kinship("outbox " + verb + " --outbox " + folder_.string());
  }

  mutable ServedStore store_;
  const std::filesystem::path folder_ = store_.beside() / "robot";
  std::vector<Uuid> reports_;
};

TEST_F(PoisonReport, IsSetAsideAloneAndOfferedAgainOnRequest) {
  const Uuid poison = reports_[4];
  test::Stranger(store_.file())
      .run("CREATE TRIGGER object BEFORE INSERT ON attempt WHEN NEW.report_uuid = x'" +
           to_hex(poison.bytes) + "' BEGIN SELECT RAISE(ROLLBACK, 'the site objects'); END");
  count_tries();
  const link::Client::OutboxState state = deliver();
  EXPECT_EQ(state.accepted, kReports - 1);
  EXPECT_EQ(state.set_aside, 1U);
  EXPECT_EQ(state.refused + state.pending, 0U);
  EXPECT_NE(state.problem.find(poison.text()), std::string::npos) << state.problem;
  EXPECT_EQ(store_.cell().status().attempts, kReports - 1);
  const test::Answer list = outbox_command("list");
  EXPECT_TRUE(list.says(poison.text())) << list.out << list.err;
  EXPECT_TRUE(list.says("the site objects")) << list.out;

  test::Stranger(store_.file()).run("DROP TRIGGER object");
  EXPECT_EQ(outbox_command("resend").code, 0);
  EXPECT_EQ(deliver().accepted, 1U);
  EXPECT_EQ(store_.cell().status().attempts, kReports);
}

}  // namespace
}  // namespace kinship::poison_report_test
