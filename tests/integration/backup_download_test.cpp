// A copy of a running server's store, fetched over DDS into a file here.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "tests/integration/admin_commands.hpp"
#include "tests/integration/incompressible_paths.hpp"

namespace kinship::backup_download_test {
namespace {

namespace fs = std::filesystem;
using admin_commands_test::Answer;
using admin_commands_test::expect_has;
using admin_commands_test::Server;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

class BackupDownload : public testing::Test {
 protected:
  BackupDownload() { fs::create_directory(backups_); }

  std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"--backup-folder", backups_.string()});
    return more;
  }
  void fill(const Server& server, std::size_t paths) {
    test::report_incompressible_paths(*server.client(folder_ / "outbox"), paths);
  }
  /// Waits until so much of a download is here. \return whether it came to that.
  static bool has_bytes(const fs::path& part, std::uintmax_t bytes) {
    std::error_code error;
    const auto give_up = Clock::now() + seconds(60);
    while (Clock::now() < give_up) {
      if (const auto size = fs::file_size(part, error); !error && size >= bytes)
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  std::string to() const { return (folder_ / "here.db").string(); }
  bool is_same() const { return test::read_text(to()) == test::read_text(backups_ / "monday.db"); }

  test::TemporaryDirectory folder_;
  const fs::path backups_ = folder_ / "backups";
};

TEST_F(BackupDownload, ABackupIsListedFetchedAndNeverOverAFileThatIsThere) {
  const Server server(folder_ / "fleet.db", arguments());
  fill(server, 2);
  server.ends(0, "backup monday.db");
  std::ofstream(backups_ / "key.pem") << "secret";
  fs::create_symlink(folder_ / "fleet.db", backups_ / "link.db");
  const Answer list = server.kinship("backup list --json");
  expect_has(list.out, "\"name\":\"monday.db\"");
  EXPECT_EQ(list.out.find("key.pem"), std::string::npos) << "is no backup";
  EXPECT_EQ(list.out.find("link.db"), std::string::npos);
  server.ends(3, "backup download key.pem --to " + to());
  server.ends(3, "backup download link.db --to " + to());
  EXPECT_FALSE(fs::exists(to() + ".part")) << "nothing came";

  const Answer answer = server.ends(0, "backup download monday.db --to " + to());
  EXPECT_TRUE(is_same());
  EXPECT_EQ(fs::status(to()).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  expect_has(answer.out, "SHA-256 ");
  const Answer again = server.kinship("backup download monday.db --to " + to());
  EXPECT_NE(again.code, 0);
  expect_has(again.err, "is there already");
}

TEST_F(BackupDownload, WhatIsLeftOfAnotherBackupIsFoundOutByItsDigest) {
  const Server server(folder_ / "fleet.db", arguments());
  fill(server, 2);
  server.ends(0, "backup monday.db");
  std::ofstream(to() + ".part") << std::string(100'000, 'x');
  const Answer answer = server.ends(0, "backup download monday.db --to " + to());
  EXPECT_TRUE(is_same());
  EXPECT_EQ(answer.out.find("were here"), std::string::npos) << answer.out;
}

TEST_F(BackupDownload, OneThatIsKilledGoesOnAndOneOutlivesTheServer) {
  // So slow that it can be met in the middle: 3 MB at once, then 0.3 MB a second.
  Server server(folder_ / "fleet.db", arguments({"--client-mb-per-s", "0.3"}));
  {
    Server filler(folder_ / "other.db", arguments());
    fill(filler, 12);
    filler.ends(0, "backup monday.db");
  }
  const fs::path part = to() + ".part";
  const std::uintmax_t whole = fs::file_size(backups_ / "monday.db");
  ASSERT_GT(whole, 4'000'000U);
  {
    test::Program download("kinship", server.with_domain("backup download monday.db --to " + to()));
    ASSERT_TRUE(has_bytes(part, 1'000'000));
    download.signal(SIGKILL);
    download.wait();
  }
  const std::uintmax_t before = fs::file_size(part);
  ASSERT_LT(before, whole) << "the test is to meet it in the middle";
  EXPECT_FALSE(fs::exists(to()));
  test::Program download("kinship",
                         server.with_domain("backup download monday.db --to " + to(), "2"));
  ASSERT_TRUE(has_bytes(part, before + 1));
  server.process().kill();
  server.start();
  const std::string said = download.read_all();
  EXPECT_EQ(download.wait(), 0);
  expect_has(said, std::to_string(before) + " of them were here");
  EXPECT_TRUE(is_same());
  EXPECT_FALSE(fs::exists(part));
}

}  // namespace
}  // namespace kinship::backup_download_test
