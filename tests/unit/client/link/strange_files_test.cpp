#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <set>

#include "client/link/outbox.hpp"
#include "client/link/report_sender.hpp"
#include "proto/json/attempt_json.hpp"
#include "tests/support/random_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::link::strange_files_test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

ReportReply stored(const ReportRequest& batch) {
  ReportReply reply;
  for (const Attempt& attempt : batch.attempts)
    reply.receipts.push_back({attempt.report_uuid, ReceiptStatus::Stored, ""});
  return reply;
}

/// An outbox in which a stranger's hand left things that have names of reports.
class StrangeFiles : public testing::Test {
 protected:
  Uuid add() {
    const Attempt attempt = values_.attempt(5);
    outbox_.add(attempt);
    return attempt.report_uuid;
  }
  fs::path strange(const char* part = "pending") {
    return folder_.path() / part / (Uuid::random().text() + ".json");
  }
  /// Waits at most as long as a test may take for what needs milliseconds.
  static void send_all(ReportSender& sender) {
    sender.wait_until_empty(std::chrono::steady_clock::now() + 30s);
  }

  test::TemporaryDirectory folder_;
  test::RandomValues values_{37};
  Outbox outbox_{folder_.path()};
};

void make_socket(const fs::path& path) {
  const fs::path before = fs::current_path();
  fs::current_path(path.parent_path());  // a socket's name is short
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  path.filename().string().copy(name.sun_path, sizeof name.sun_path - 1);
  const int descriptor = socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&name), sizeof name), 0);
  close(descriptor);
  fs::current_path(before);
}

TEST_F(StrangeFiles, EachIsNamedAndPassedByAndTheOthersGo) {
  std::set<std::string> names;
  const auto next = [&] {
    const fs::path file = strange();
    names.insert("pending/" + file.filename().string());
    return file;
  };
  add();
  fs::create_directories(next() / "full");
  ASSERT_EQ(mkfifo(next().c_str(), 0600), 0);
  const fs::path loop = next();
  fs::create_symlink(loop, loop);
  fs::create_symlink("nowhere", next());
  fs::create_symlink("/dev/zero", next());
  fs::create_symlink("/proc/self/mem", next());  // EIO
  make_socket(next());
  add();
  ReportSender sender(outbox_, stored);
  send_all(sender);
  add();  // what comes later goes, too
  sender.wake();
  send_all(sender);
  const ReportSender::Counts counts = sender.counts();
  EXPECT_EQ(counts.accepted, 3U);
  EXPECT_EQ(counts.refused, 0U);
  EXPECT_EQ(counts.passed_by, names.size());
  EXPECT_NE(counts.problem.find("7 reports are passed by"), std::string::npos) << counts.problem;
  std::set<std::string> listed, reasons;
  for (const OutboxEntry& entry : outbox_.entries()) {
    listed.insert(entry.file);
    reasons.insert(entry.why);
    EXPECT_EQ(entry.state, "pending");
    EXPECT_NE(entry.why.find(entry.file), std::string::npos) << entry.why;
  }
  EXPECT_EQ(listed, names);
  EXPECT_EQ(reasons.size(), names.size());
}

TEST_F(StrangeFiles, WhatIsMendedGoesAMinuteLater) {
  const Uuid report = add();
  const fs::path file = folder_.path() / "pending" / (report.text() + ".json");
  fs::rename(file, folder_.path() / "whole");
  fs::create_directory(file);
  std::atomic<std::chrono::seconds> later = 0s;
  ReportSender sender(outbox_, stored, {},
                      [&] { return std::chrono::steady_clock::now() + later.load(); });
  while (sender.counts().passed_by == 0)
    std::this_thread::yield();
  fs::remove(file);
  fs::rename(folder_.path() / "whole", file);
  later = 61s;
  sender.retry();
  while (sender.counts().accepted == 0)
    std::this_thread::yield();
  EXPECT_EQ(sender.counts().passed_by, 0U);
  EXPECT_EQ(sender.counts().problem, "");
}

TEST_F(StrangeFiles, WhatStandsWhereAReportShallGoHoldsUpNoOther) {
  const Uuid report = add();
  add();
  fs::create_directories(folder_.path() / "sent" / (report.text() + ".json") / "full");
  ReportSender sender(outbox_, stored);
  send_all(sender);
  EXPECT_EQ(sender.counts().accepted, 1U);
  EXPECT_EQ(sender.counts().passed_by, 1U);
  EXPECT_EQ(outbox_.pending(), std::vector{report}) << "it is not lost";
}

TEST_F(StrangeFiles, ADescriptionThatCannotBeReadHoldsUpNoOtherRobot) {
  const Attempt unknown = values_.attempt(5);
  outbox_.add(unknown);
  add();
  ASSERT_EQ(mkfifo((folder_.path() / "robots" / (unknown.robot.hex() + ".json")).c_str(), 0600), 0);
  ReportSender sender(
      outbox_,
      [&](const ReportRequest& batch) {
        ReportReply reply = stored(batch);
        for (Receipt& receipt : reply.receipts)
          if (receipt.report_uuid == unknown.report_uuid)
            receipt.status = ReceiptStatus::UnknownRobot;
        return reply;
      },
      [](const RobotDescription&) { return RegisterReply{}; });
  while (sender.counts().accepted == 0 || sender.counts().problem.empty())
    std::this_thread::yield();
  EXPECT_NE(sender.counts().problem.find("no regular file"), std::string::npos)
      << sender.counts().problem;
}

/// In a process of nobody: root may read everything.
/// \return what the process says of itself: 0 is well.
int as_nobody(const std::function<int()>& work) {
  constexpr uid_t kNobody = 65534;
  const pid_t child = fork();
  if (child == 0)
    _exit(setresgid(kNobody, kNobody, kNobody) == 0 && setresuid(kNobody, kNobody, kNobody) == 0
              ? work()
              : 77);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(StrangeFiles, AFileOfSomebodyElseIsPassedBy) {
  constexpr uid_t kNobody = 65534;
  if (geteuid() != 0)
    GTEST_SKIP() << "only root becomes somebody else";
  const fs::path closed = folder_.path() / "pending" / (add().text() + ".json");
  add();
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path()))
    ASSERT_EQ(chown(entry.path().c_str(), kNobody, kNobody), 0);
  ASSERT_EQ(chown(folder_.path().c_str(), kNobody, kNobody), 0);
  ASSERT_EQ(chown(closed.c_str(), 0, 0), 0);
  ASSERT_EQ(chmod(closed.c_str(), 0600), 0);
  const int outcome = as_nobody([&] {
    Outbox outbox(folder_.path());
    ReportSender sender(outbox, stored);
    send_all(sender);
    const ReportSender::Counts counts = sender.counts();
    if (counts.accepted != 1 || counts.passed_by != 1)
      return 1;
    return counts.problem.find("Permission denied") == std::string::npos ? 2 : 0;
  });
  EXPECT_EQ(outcome, 0);
  EXPECT_TRUE(fs::exists(closed));
}

}  // namespace
}  // namespace kinship::link::strange_files_test
