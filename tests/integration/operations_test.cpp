// What an installation runs beside kinshipd: the copies of every night, the units of systemd.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <set>
#include <string>

#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::operations_test {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(test::source_dir()) / "deploy";

std::set<std::string> names_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.insert(entry.path().filename().string());
  return names;
}

class BackupScript : public testing::Test {
 protected:
  BackupScript() {
    std::filesystem::create_directory(backups_);
    const char* const path = std::getenv("PATH");
    setenv("PATH", (test::bin_dir() + ":" + (path == nullptr ? "" : path)).c_str(), 1);
    setenv("KINSHIP_DOMAIN", std::to_string(domain_.number()).c_str(), 1);
    setenv("KINSHIP_BACKUPS", "2", 1);
  }
  void TearDown() override {
    unsetenv("KINSHIP_DOMAIN");
    unsetenv("KINSHIP_BACKUPS");
  }

  int run(const std::filesystem::path& folder) const {
    const std::string command = (kDeploy / "systemd" / "backup").string() + " '" + folder.string() +
                                "' > '" + (directory_ / "said").string() + "' 2>&1";
    return WEXITSTATUS(std::system(command.c_str()));  // NOLINT(concurrency-mt-unsafe)
  }
  std::string said() const { return test::read_text(directory_ / "said"); }

  test::TemporaryDirectory directory_;
  std::filesystem::path backups_ = directory_ / "backups";
  test::ReservedDomain domain_;
};

TEST_F(BackupScript, KeepsTheNewestCopiesAndWhatIsNoneOfItsOwn) {
  const test::ServerProcess server({.store = directory_ / "fleet.db",
                                    .domain = domain_.number(),
                                    .arguments = {"--backup-folder", backups_.string()}});
  for (const char* const name :
       {"kinship-20200101T000000Z.db", "kinship-20200102T000000Z.db", "monday.db"})
    std::ofstream(backups_ / name) << "a copy of before";
  ASSERT_EQ(run(backups_), 0) << said();
  const auto names = names_in(backups_);
  EXPECT_EQ(names.size(), 3U);
  EXPECT_TRUE(names.contains("monday.db"));
  EXPECT_TRUE(names.contains("kinship-20200102T000000Z.db"));
  EXPECT_NE(said().find("removed kinship-20200101T000000Z.db"), std::string::npos) << said();
}

TEST_F(BackupScript, RemovesNothingWithoutANewCopy) {
  for (const char* const name : {"kinship-20200101T000000Z.db", "kinship-20200102T000000Z.db",
                                 "kinship-20200103T000000Z.db"})
    std::ofstream(backups_ / name) << "a copy of before";
  EXPECT_EQ(run(backups_), 4) << said();  // no server
  EXPECT_EQ(names_in(backups_).size(), 3U);
}

TEST_F(BackupScript, RefusesWhatItCannotMean) {
  EXPECT_EQ(run(directory_ / "nowhere"), 2);
  EXPECT_NE(said().find("nowhere' is no folder"), std::string::npos) << said();
  setenv("KINSHIP_BACKUPS", "none", 1);
  EXPECT_EQ(run(backups_), 2);
  EXPECT_NE(said().find("'none', not a number"), std::string::npos) << said();
}

}  // namespace
}  // namespace kinship::operations_test
