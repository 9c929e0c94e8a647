#include "server/app/offline.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "server/store/sqlite/database/database.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app::offline_test {
namespace {

namespace fs = std::filesystem;

class Offline : public testing::Test {
 protected:
  Offline() { fs::copy_file(test::source_dir() + "/tests/golden/store-5.db", store_); }

  int run(OfflineVerb verb, const fs::path& store, const fs::path& file = {}, bool json = false) {
    out_.str("");
    err_.str("");
    return run_offline({verb, store, file, json}, out_, err_, false);
  }

  const test::TemporaryDirectory directory_;
  const fs::path store_ = directory_ / "store.db";
  const fs::path copy_ = directory_ / "copy.db";
  std::ostringstream out_, err_;
};

TEST_F(Offline, TheVerbsDoWhatTheySay) {
  EXPECT_EQ(run(OfflineVerb::Migrate, store_), kDone) << err_.str();
  EXPECT_EQ(out_.str(), "store '" + store_.string() + "': schema 5 already\n");
  EXPECT_EQ(run(OfflineVerb::Backup, store_, copy_), kDone) << err_.str();
  EXPECT_EQ(run(OfflineVerb::Restore, store_, copy_), kDone) << err_.str();
  EXPECT_NE(out_.str().find(store_.string() + ".replaced-"), std::string::npos) << out_.str();
  EXPECT_EQ(run(OfflineVerb::Check, store_), kDone);
  EXPECT_NE(out_.str().find("sound"), std::string::npos) << out_.str();
  EXPECT_EQ(err_.str(), "");
}

TEST_F(Offline, ARepairSaysWhatIsLostAndWhereTheDamagedStoreIs) {
  store::Database(store_, store::Access::ReadWrite)
      .execute(
          "UPDATE robot SET dof = 5 WHERE label = 'iiwa';"
          "UPDATE task SET name = 'shelv' WHERE name = 'shelf'");
  EXPECT_EQ(run(OfflineVerb::Check, store_), kFailed);
  EXPECT_NE(out_.str().find("task: 1: damaged (checksum)\n"), std::string::npos) << out_.str();
  EXPECT_EQ(run(OfflineVerb::Repair, store_), kFailed);  // it holds robots to be registered anew
  EXPECT_NE(out_.str().find("; 2 damaged places were left behind\n"), std::string::npos)
      << out_.str();
  EXPECT_NE(out_.str().find("missing: task 1\n"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("still wrong: robot: 'iiwa': its row is damaged"), std::string::npos)
      << out_.str();
  EXPECT_NE(out_.str().find("the damaged store is now '" + store_.string() + ".replaced-"),
            std::string::npos)
      << out_.str();
}

TEST_F(Offline, ARepairOfASoundStoreLosesNothing) {
  EXPECT_EQ(run(OfflineVerb::Repair, store_), kDone);
  EXPECT_NE(out_.str().find("; 0 damaged places were left behind\ntable robot: "),
            std::string::npos)
      << out_.str();
  EXPECT_NE(out_.str().find("table path: 14 rows before, 14 after, 0 missing\n"), std::string::npos)
      << out_.str();
  EXPECT_EQ(out_.str().find("\nmissing: "), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("nothing was lost\n"), std::string::npos) << out_.str();
}

TEST_F(Offline, ACheckIsOneDocumentForPrograms) {
  EXPECT_EQ(run(OfflineVerb::Check, store_, {}, true), kDone);
  EXPECT_EQ(out_.str().find(R"({"format":"kinship.store-check/1","file":")" + store_.string() +
                            "\",\"epoch\":\""),
            0U);
  EXPECT_NE(out_.str().find("{\"name\":\"path\",\"rows\":14,\"problems\":0}"), std::string::npos);
  EXPECT_NE(out_.str().find("\"problems\":0,\"messages\":[]}\n"), std::string::npos) << out_.str();
}

TEST_F(Offline, ExitCodesTellWhatWentWrong) {
  EXPECT_EQ(run(OfflineVerb::Check, directory_ / "none.db"), kNotFound);
  EXPECT_NE(err_.str().find("none.db"), std::string::npos);
  EXPECT_EQ(run(OfflineVerb::Restore, store_, directory_ / "none.db"), kNotFound);
  EXPECT_EQ(run(OfflineVerb::Backup, store_, store_), kFailed);  // is there already
  EXPECT_EQ(run(OfflineVerb::Restore, store_, store_), kWrongUsage);
  EXPECT_EQ(out_.str(), "");
}

TEST_F(Offline, OfADatabaseTheVerbsSayWhatDoesTheirWorkThere) {
  const std::map<OfflineVerb, std::string> instead = {{OfflineVerb::Check, "pg_amcheck"},
                                                      {OfflineVerb::Backup, "pg_dump"},
                                                      {OfflineVerb::Restore, "pg_restore"},
                                                      {OfflineVerb::Repair, "standby"},
                                                      {OfflineVerb::Migrate, "first server"}};
  for (const auto& [verb, what] : instead) {
    EXPECT_EQ(run(verb, "postgresql://kinship:secret@127.0.0.1:1/fleet", copy_), kWrongUsage);
    EXPECT_NE(err_.str().find(what), std::string::npos) << err_.str();
    EXPECT_EQ(err_.str().find("secret"), std::string::npos) << err_.str();
  }
  EXPECT_EQ(run(OfflineVerb::Check, "mysql://host/fleet"), kWrongUsage);
  EXPECT_NE(err_.str().find("'mysql://' is not known"), std::string::npos) << err_.str();
  EXPECT_FALSE(fs::exists("mysql:"));
}

TEST_F(Offline, ATerminalSeesHowFarItIs) {
  EXPECT_EQ(run_offline({OfflineVerb::Check, store_, {}, false}, out_, err_, true), kDone);
  EXPECT_NE(err_.str().find("100 %"), std::string::npos);
  EXPECT_EQ(err_.str().substr(err_.str().size() - 7), "\r     \r");
}

}  // namespace
}  // namespace kinship::app::offline_test
