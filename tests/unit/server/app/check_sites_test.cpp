#include "server/app/check_sites.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "proto/types/exit_code.hpp"
#include "server/app/options.hpp"
#include "server/store/sqlite/opening/migrations.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app::check_sites_test {
namespace {

class CheckSites : public testing::Test {
 protected:
  /// A store with one report of this UUID; `content` says what is in it.
  std::string store_with(const char* name, std::uint64_t content) {
    const std::filesystem::path file = folder_ / name;
    const auto store = store::open_sqlite_store(file);
    EXPECT_TRUE(store->register_robot(robot_));
    Attempt attempt = test::make_attempt(robot_.digest, "shelf", content);
    attempt.report_uuid = uuid_;
    test::report(*store, {attempt});
    return file.string();
  }
  static std::string content_of(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  int check(const std::string& site, const std::string& memory) {
    out_.str("");
    err_.str("");
    const char* const words[] = {"kinshipd",   "sites",    "check",       "--site",
                                 site.c_str(), "--memory", memory.c_str()};
    const Options options = parse_arguments(7, words, out_, err_);
    return run_check_sites(std::get<CheckSitesOptions>(options), out_, err_);
  }

  const test::TemporaryDirectory folder_;
  const store::RobotRecord robot_ = test::make_robot("panda", 1);
  const Uuid uuid_ = test::id_from<Uuid>(1);
  std::ostringstream out_, err_;
};

TEST_F(CheckSites, NamesOneUuidWithTwoContents) {
  const std::string site = store_with("site.db", 1), same = store_with("same.db", 1),
                    other = store_with("other.db", 2);
  EXPECT_EQ(check(site, same), kDone) << err_.str();
  EXPECT_EQ(
      out_.str(),
      "the same: 1; at the site alone: 0; in the memory alone: 0; different: 0; damaged: 0\n");
  EXPECT_EQ(check(site, other), kFailed);
  EXPECT_NE(out_.str().find("report " + uuid_.text() + ": one UUID, two contents\n"),
            std::string::npos)
      << out_.str();
}

TEST_F(CheckSites, LeavesAFileAndWhatLiesBesideItAsTheyAre) {
  const std::string site = store_with("site.db", 1), served = (folder_ / "served.db").string();
  const std::filesystem::path backups = folder_ / "what is 100%? #1";
  std::filesystem::create_directory(backups);
  const std::string backup = (backups / "copy.db").string();
  std::filesystem::copy_file(site, backup);  // its header asks for a WAL
  const std::string before = content_of(backup);
  const auto server = store::open_sqlite_store(served);
  EXPECT_EQ(check(backup, served), kDone) << err_.str();
  EXPECT_NE(out_.str().find("at the site alone: 1"), std::string::npos) << out_.str();
  EXPECT_EQ(content_of(backup), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(backups), {}), 1)
      << "no lock, no WAL, no mark";
}

TEST_F(CheckSites, RefusesAnotherSchema) {
  const std::string site = store_with("site.db", 1), older = (folder_ / "older.db").string();
  std::ofstream(older).close();
  const auto known = store::embedded_migrations();
  static_cast<void>(store::open_migrated(older, known.first(known.size() - 1)));
  const std::string before = content_of(older);
  EXPECT_EQ(check(site, older), kFailed);
  EXPECT_NE(err_.str().find("has schema"), std::string::npos) << err_.str();
  EXPECT_EQ(content_of(older), before);
}

TEST_F(CheckSites, MakesNoStore) {
  const std::string site = store_with("site.db", 1), none = (folder_ / "none.db").string();
  EXPECT_EQ(check(site, none), kNotFound);
  EXPECT_FALSE(std::filesystem::exists(none));
  EXPECT_NE(err_.str().find("there is none"), std::string::npos) << err_.str();
}

}  // namespace
}  // namespace kinship::app::check_sites_test
