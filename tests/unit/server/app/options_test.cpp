#include "server/app/options.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::app::options_test {
namespace {

class Options : public testing::Test {
 protected:
  Options() {
    unsetenv("KINSHIP_DOMAIN");
    unsetenv("ROS_DOMAIN_ID");
    setenv("XDG_STATE_HOME", "/state", 1);
  }

  app::Options parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "kinshipd");
    out_.str("");
    err_.str("");
    return parse_arguments(static_cast<int>(arguments.size()), arguments.data(), out_, err_);
  }
  ServerOptions good(const std::vector<const char*>& arguments) {
    return std::get<ServerOptions>(parse(arguments));
  }
  int code(const std::vector<const char*>& arguments) { return std::get<int>(parse(arguments)); }

  std::ostringstream out_, err_;
};

TEST_F(Options, WithoutArgumentsItServesTheStoreOfTheUser) {
  const ServerOptions options = good({});
  EXPECT_EQ(options.store, "/state/kinship/experience.db");
  EXPECT_EQ(options.domain, 0U);
  EXPECT_GE(options.workers, 1U);
  EXPECT_EQ(options.log_level, "info");
  EXPECT_EQ(options.rehearsal_fraction, 0.1);
  EXPECT_EQ(options.scrub_mb_per_s, 4.0);
  EXPECT_EQ(options.free_space_watermark_mb, 64U);
  EXPECT_EQ(options.ballast_mb, 16U);
  EXPECT_EQ(options.max_wal_mb, 512U);
  EXPECT_EQ(options.max_paths_per_pair, 20'000U);
  EXPECT_EQ(options.stored_distributions_mb, 1024U);
  EXPECT_EQ(options.search_records_mb, 256U);
  EXPECT_EQ(options.search_record_days, 90U);
  EXPECT_EQ(options.distribution_memory_mb, 128U);
  EXPECT_EQ(options.path_memory_mb, 64U);
}

TEST_F(Options, WhatIsKeptHasLimitsOrNone) {
  const ServerOptions options = good({"--max-paths-per-pair", "0", "--stored-distributions-mb", "0",
                                      "--distribution-memory-mb", "1", "--path-memory-mb", "2",
                                      "--search-records-mb", "0", "--search-record-days", "7"});
  EXPECT_EQ(options.search_records_mb, 0U);
  EXPECT_EQ(options.search_record_days, 7U);
  EXPECT_EQ(options.max_paths_per_pair, 0U);
  EXPECT_EQ(options.stored_distributions_mb, 0U);
  EXPECT_EQ(options.distribution_memory_mb, 1U);
  EXPECT_EQ(options.path_memory_mb, 2U);
  EXPECT_EQ(code({"--distribution-memory-mb", "0"}), kWrongUsage);
  EXPECT_EQ(code({"--max-paths-per-pair", "-1"}), kWrongUsage);
  EXPECT_EQ(code({"--max-paths-per-pair", "many"}), kWrongUsage);
}

TEST_F(Options, WhatTheStoreMayTakeOfItsDiskIsInMegabytes) {
  const ServerOptions options =
      good({"--free-space-watermark-mb", "500", "--ballast-mb", "0", "--max-wal-mb", "64"});
  EXPECT_EQ(options.free_space_watermark_mb, 500U);
  EXPECT_EQ(options.ballast_mb, 0U);
  EXPECT_EQ(options.max_wal_mb, 64U);
  EXPECT_EQ(code({"--max-wal-mb", "0"}), kWrongUsage);
  EXPECT_EQ(code({"--ballast-mb", "-1"}), kWrongUsage);
  EXPECT_EQ(code({"--free-space-watermark-mb", "much"}), kWrongUsage);
}

TEST_F(Options, TheStoreIsUnderHomeIfXdgSaysNothingUsable) {
  setenv("HOME", "/home/someone", 1);
  setenv("XDG_STATE_HOME", "relative", 1);
  EXPECT_EQ(default_store(), "/home/someone/.local/state/kinship/experience.db");
  unsetenv("XDG_STATE_HOME");
  EXPECT_EQ(default_store(), "/home/someone/.local/state/kinship/experience.db");
}

TEST_F(Options, MetricsAreServedWhereSomebodySaysSo) {
  EXPECT_EQ(good({}).metrics, "");
  EXPECT_EQ(good({"--metrics", "127.0.0.1:9464"}).metrics, "127.0.0.1:9464");
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << "metrics = \"[::1]:9464\"\n";
  EXPECT_EQ(good({"--config", file.c_str()}).metrics, "[::1]:9464");
  for (const char* const wrong : {"9464", "localhost:9464", "127.0.0.1", "127.0.0.1:99999", ""}) {
    EXPECT_EQ(code({"--metrics", wrong}), kWrongUsage) << wrong;
    EXPECT_NE(err_.str().find("'" + std::string(wrong) + "' is not an address and a port"),
              std::string::npos)
        << err_.str();
  }
}

TEST_F(Options, AMoveIsFromOnePlaceToAnother) {
  const auto move = [this](std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "migrate-store");
    return parse(std::move(arguments));
  };
  const app::Options moved = move({"--from", "a.db", "--to", "postgresql://h/d"});
  ASSERT_TRUE(std::holds_alternative<MigrateStoreOptions>(moved)) << err_.str();
  EXPECT_EQ(std::get<MigrateStoreOptions>(moved).from, "a.db");
  EXPECT_EQ(std::get<MigrateStoreOptions>(moved).to, "postgresql://h/d");
  EXPECT_TRUE(std::get<MigrateStoreOptions>(move({"--give-up", "--to", "a.db"})).give_up);
  for (const std::vector<const char*>& wrong : std::vector<std::vector<const char*>>{
           {}, {"--from", "a.db"}, {"--to", "a.db"}, {"--give-up"}, {"a.db", "b.db"}})
    EXPECT_EQ(std::get<int>(move(wrong)), kWrongUsage) << err_.str();
  EXPECT_EQ(std::get<int>(move({"--help"})), kDone);
  EXPECT_NE(out_.str().find("Examples:\n  kinshipd migrate-store --from fleet.db"),
            std::string::npos);
}

TEST_F(Options, ASecurityFolderMustBeThere) {
  EXPECT_TRUE(good({}).security.empty());
  const test::TemporaryDirectory directory;
  const std::string folder = (directory / ".").string();
  EXPECT_EQ(good({"--security", folder.c_str()}).security, folder);
  EXPECT_EQ(code({"--security", "/no/such/folder"}), kWrongUsage);
}

TEST_F(Options, OtherHostsAreServedWithSecurityOrIfInsecureIsSpeltOut) {
  const test::TemporaryDirectory directory;
  const std::string folder = directory.path().string();
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << "interface = \"eth0\"\n";
  for (const std::vector<const char*>& arguments :
       std::vector<std::vector<const char*>>{{"--interface", "eth0"}, {"--config", file.c_str()}}) {
    EXPECT_EQ(code(arguments), kWrongUsage);
    EXPECT_EQ(out_.str(), "");
    for (const char* const words : {"interface 'eth0' is served without security", "--insecure",
                                    "kinshipd secure init", "--security FOLDER"})
      EXPECT_NE(err_.str().find(words), std::string::npos) << err_.str();
  }
  EXPECT_EQ(token_file_of(good({"--interface", "eth0", "--insecure", "--store", "a/f.db"})),
            "a/f.db.token");
  EXPECT_EQ(token_file_of(
                good({"--interface", "eth0", "--insecure", "--token-file", "/run/kinship/token"})),
            "/run/kinship/token");
  EXPECT_EQ(token_file_of(good({"--token-file", "/run/kinship/token"})), "") << "loopback";
  EXPECT_NE(insecurity_of(good({"--interface", "eth0", "--insecure"})), "");
  EXPECT_EQ(insecurity_of(good({"--interface", "eth0", "--security", folder.c_str()})), "");
  EXPECT_EQ(insecurity_of(good({"--interface", "lo"})), "");
  EXPECT_EQ(insecurity_of(good({"--insecure"})), "") << "nobody else is served";
  std::ofstream(file, std::ios::app) << "insecure = true\n";
  EXPECT_TRUE(good({"--config", file.c_str()}).insecure);
  EXPECT_EQ(code({"--interface", "eth0", "--print-config"}), kDone);
  EXPECT_NE(out_.str().find("[default]\ninsecure = false\n"), std::string::npos) << out_.str();
  EXPECT_EQ(code({"--insecure", "--print-config"}), kDone);
  EXPECT_NE(out_.str().find("[command line]\ninsecure = true\n"), std::string::npos);
}

TEST_F(Options, RosNodesAreServedOnTheirDomainAndBesideCertificatesWithTheirOwn) {
  EXPECT_FALSE(good({}).ros2);
  EXPECT_TRUE(good({"--ros2"}).ros2);
  EXPECT_EQ(good({"--ros2", "--ros2-domain", "7"}).ros2_domain, 7U);
  ASSERT_EQ(setenv("ROS_DOMAIN_ID", "232", 1), 0);
  EXPECT_FALSE(good({}).ros2) << "a domain that only ROS may have is nothing to a server without";
  EXPECT_EQ(code({"--ros2"}), kWrongUsage);
  EXPECT_NE(err_.str().find("ROS_DOMAIN_ID"), std::string::npos) << err_.str();
  const test::TemporaryDirectory directory;
  const std::string folder = directory.path().string();
  EXPECT_EQ(code({"--ros2", "--ros2-domain", "0", "--security", folder.c_str()}), kWrongUsage);
  EXPECT_NE(err_.str().find("needs --ros2-enclave"), std::string::npos) << err_.str();
  EXPECT_EQ(code({"--ros2", "--ros2-domain", "0", "--ros2-enclave", folder.c_str()}), kWrongUsage);
  EXPECT_NE(err_.str().find("' secures ROS 2 alone"), std::string::npos) << err_.str();
  EXPECT_EQ(code({"--ros2", "--ros2-domain", "0", "--ros2-enclave", folder.c_str(), "--security",
                  folder.c_str()}),
            kWrongUsage);
  EXPECT_NE(err_.str().find("--ros2-domain 0 (or ROS_DOMAIN_ID) is --domain's"), std::string::npos)
      << err_.str();
  EXPECT_EQ(good({"--ros2", "--ros2-domain", "1", "--ros2-enclave", folder.c_str(), "--security",
                  folder.c_str()})
                .ros2_enclave,
            folder);
  unsetenv("ROS_DOMAIN_ID");
}

TEST_F(Options, WhatCycloneDdsIsToldToOpenHasToBeSpeltOutToo) {
  const test::TemporaryDirectory directory;
  const std::string folder = directory.path().string();
  ASSERT_EQ(setenv("CYCLONEDDS_URI", "file:///etc/cyclonedds.xml", 1), 0);
  EXPECT_EQ(code({}), kWrongUsage);
  EXPECT_NE(err_.str().find("CYCLONEDDS_URI is set"), std::string::npos) << err_.str();
  EXPECT_NE(insecurity_of(good({"--insecure"})), "");
  EXPECT_EQ(insecurity_of(good({"--security", folder.c_str()})), "");
  unsetenv("CYCLONEDDS_URI");
  EXPECT_EQ(insecurity_of(good({})), "");
}

TEST_F(Options, TheTokenOfAServerOverADatabaseHasAPlace) {
  const std::vector<const char*> arguments = {"--interface", "eth0", "--insecure", "--store",
                                              "postgresql://kinship@localhost/kinship"};
  EXPECT_EQ(token_file_of(good(arguments)), "/state/kinship/experience.db.token");
  const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "/";
  unsetenv("XDG_STATE_HOME");
  unsetenv("HOME");
  EXPECT_EQ(code(arguments), kWrongUsage);
  EXPECT_NE(err_.str().find("--token-file FILE"), std::string::npos) << err_.str();
  setenv("HOME", home.c_str(), 1);
}

TEST_F(Options, ArgumentsAreTaken) {
  const ServerOptions options = good({"--store", "fleet.db", "--domain", "7", "--workers", "4",
                                      "--interface", "eth0", "--insecure", "--log-level", "error"});
  EXPECT_EQ(options.store, "fleet.db");
  EXPECT_EQ(options.domain, 7U);
  EXPECT_EQ(options.workers, 4U);
  EXPECT_EQ(options.network_interface, "eth0");
  EXPECT_EQ(options.log_level, "error");
}

TEST_F(Options, TheScrubHasARate) {
  EXPECT_EQ(good({"--scrub-mb-per-s", "0.5"}).scrub_mb_per_s, 0.5);
  EXPECT_EQ(good({"--scrub-mb-per-s", "0"}).scrub_mb_per_s, 0.0);
  for (const char* const wrong : {"-1", "1001", "nan", "fast"})
    EXPECT_EQ(code({"--scrub-mb-per-s", wrong}), kWrongUsage) << wrong;
}

TEST_F(Options, APartOfAProcessorIsANumberFromZeroToOne) {
  EXPECT_EQ(good({"--rehearsal-cpu", "0"}).rehearsal_fraction, 0.0);
  EXPECT_EQ(good({"--rehearsal-cpu", "1"}).rehearsal_fraction, 1.0);
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.ini").string();
  std::ofstream(file) << "rehearsal-cpu=0.25\n";
  EXPECT_EQ(good({"--config", file.c_str()}).rehearsal_fraction, 0.25);
  for (const char* wrong : {"-0.1", "1.01", "nan", "inf", "much", ""}) {
    EXPECT_EQ(code({"--rehearsal-cpu", wrong}), kWrongUsage) << wrong;
    EXPECT_NE(err_.str().find("'" + std::string(wrong) + "' is not a number from 0 to 1"),
              std::string::npos)
        << err_.str();
  }
  std::ofstream(file) << "rehearsal-cpu=nan\n";
  EXPECT_EQ(code({"--config", file.c_str()}), kWrongUsage);
}

TEST_F(Options, TheCommandLineGoesBeforeTheFileAndThatBeforeTheEnvironment) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.ini").string();
  std::ofstream(file) << "domain=3\nworkers=5\n";
  EXPECT_EQ(good({"--config", file.c_str()}).domain, 3U);
  EXPECT_EQ(good({"--config", file.c_str()}).workers, 5U);
  setenv("KINSHIP_DOMAIN", "4", 1);
  EXPECT_EQ(good({"--config", file.c_str(), "--domain", "9"}).domain, 9U);
  EXPECT_EQ(good({"--config", file.c_str()}).domain, 3U);
  EXPECT_EQ(good({}).domain, 4U);
}

TEST_F(Options, WrongUsageIsSaidOnTheErrorStream) {
  for (const std::vector<const char*>& arguments :
       std::vector<std::vector<const char*>>{{"--domain", "231"},
                                             {"--workers", "0"},
                                             {"--nonsense"},
                                             {"--log-level", "loud"},
                                             {"--config", "/no/such/file"},
                                             {"serve"}}) {
    EXPECT_EQ(code(arguments), kWrongUsage);
    EXPECT_EQ(out_.str(), "");
    EXPECT_NE(err_.str(), "");
  }
}

TEST_F(Options, AVerbComesWithItsStoreAndFile) {
  const auto verb = [this](const std::vector<const char*>& arguments) {
    return std::get<OfflineOptions>(parse(arguments));
  };
  const OfflineOptions restore = verb({"restore", "--store", "fleet.db", "copy.db"});
  EXPECT_EQ(restore.verb, OfflineVerb::Restore);
  EXPECT_EQ(restore.store, "fleet.db");
  EXPECT_EQ(restore.file, "copy.db");
  EXPECT_EQ(verb({"backup", "copy.db"}).store, "/state/kinship/experience.db");
  EXPECT_TRUE(verb({"check", "--json"}).json);
  EXPECT_EQ(verb({"migrate"}).verb, OfflineVerb::Migrate);
  EXPECT_EQ(verb({"repair", "--store", "fleet.db"}).verb, OfflineVerb::Repair);
  for (const std::vector<const char*>& arguments :
       std::vector<std::vector<const char*>>{{"backup"},
                                             {"restore", "--store", "fleet.db"},
                                             {"check", "copy.db"},
                                             {"check", "migrate"},
                                             {"check", "--store", ""},
                                             {"migrate", "--json"},
                                             {"--store", "fleet.db", "check"}}) {
    EXPECT_EQ(code(arguments), kWrongUsage) << arguments[0];
    EXPECT_NE(err_.str(), "");
  }
}

TEST_F(Options, HelpAndVersionGoToTheOutput) {
  EXPECT_EQ(code({"--help"}), kDone);
  EXPECT_NE(out_.str().find("Examples:"), std::string::npos);
  EXPECT_EQ(code({"--version"}), kDone);
  EXPECT_EQ(out_.str().find("kinshipd "), 0U);
}

TEST_F(Options, WhatIsWrongInTheFileIsWrongUsageThatNamesIt) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.ini").string();
  for (const char* line : {"nonsense=4", "[[[broken", "[server]\nworkers=2"}) {
    std::ofstream(file) << "domain=3\n" << line << "\n";
    EXPECT_EQ(code({"--config", file.c_str()}), kWrongUsage) << line;
    const std::string named = std::string(line).substr(0, std::string(line).find_first_of("=]"));
    EXPECT_NE(err_.str().find(named.substr(named.find_first_not_of('['))), std::string::npos)
        << err_.str();
  }
}

TEST_F(Options, AWrongLineOfAConfigurationIsSaidWithItsFile) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.ini").string();
  std::ofstream(file) << "storee=x\n";
  EXPECT_EQ(code({"--config", file.c_str()}), kWrongUsage);
  EXPECT_NE(err_.str().find("'" + file + "'"), std::string::npos) << err_.str();
  EXPECT_NE(err_.str().find("storee"), std::string::npos) << err_.str();
}

TEST_F(Options, AMisspeltNameIsAnsweredWithTheNearestOne) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << "storee = \"x\"\n";
  EXPECT_EQ(code({"--config", file.c_str()}), kWrongUsage);
  EXPECT_NE(err_.str().find("(did you mean 'store'?)"), std::string::npos) << err_.str();
  EXPECT_EQ(code({"--wrokers", "3"}), kWrongUsage);
  EXPECT_NE(err_.str().find("'--wrokers' (did you mean '--workers'?)"), std::string::npos)
      << err_.str();
  EXPECT_EQ(code({"--workers", "3", "--utterly-else"}), kWrongUsage);
  EXPECT_EQ(err_.str().find("did you mean"), std::string::npos) << err_.str();
}

TEST_F(Options, ThePrintedConfigurationSaysWhereEachValueIsFrom) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << "workers = 5\nlog-level = \"error\"\n";
  setenv("KINSHIP_DOMAIN", "4", 1);
  EXPECT_EQ(code({"--config", file.c_str(), "--print-config", "--log-level", "debug"}), kDone);
  const std::string text = out_.str();
  const std::vector<std::string> parts = {
      "[" + file + "]\nworkers = 5\n", "[command line]\nlog-level = \"debug\"\n",
      "[KINSHIP_DOMAIN]\ndomain = 4\n", "[default]\nmax-wal-mb = 512\n",
      "[default]\n# backup-folder = \"\"\n"};
  for (const std::string& part : parts)
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST_F(Options, NothingThatIsPrintedHasAPassword) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << "upstream = \"postgres://db2/memory?password=s3cret&user=ann\"\n";
  EXPECT_EQ(code({"--store", "postgresql://ann:s3cret@db1/fleet", "--config", file.c_str(),
                  "--print-config"}),
            kDone);
  const std::string text = out_.str();
  EXPECT_EQ(text.find("s3cret"), std::string::npos) << text;
  for (const std::string& part :
       {std::string("[command line; its password is not shown]\n"
                    "store = \"postgresql://ann@db1/fleet\"\n"),
        "[" + file +
            "; its password is not shown]\nupstream = \"postgres://db2/memory?user=ann\"\n"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
  const std::string url = "postgresql://ann:s3cret@db1/fleet";
  for (const std::vector<const char*>& wrong :
       std::vector<std::vector<const char*>>{{url.c_str()},
                                             {"--domain", url.c_str()},
                                             {"check", url.c_str()},
                                             {"--log-level", url.c_str()}}) {
    EXPECT_EQ(code(wrong), kWrongUsage);
    EXPECT_EQ(err_.str().find("s3cret"), std::string::npos) << err_.str();
    EXPECT_NE(err_.str().find("ann@db1/fleet"), std::string::npos) << err_.str();
  }
  EXPECT_EQ(good({"--store", url.c_str()}).store, url) << "it is used all the same";
}

TEST_F(Options, ThePrintedConfigurationIsAFileThatSaysTheSame) {
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  EXPECT_EQ(code({"--print-config", "--domain", "9", "--rehearsal-cpu", "0.25", "--store",
                  "/a \"place\"/x.db"}),
            kDone);
  std::ofstream(file) << out_.str();
  const ServerOptions options = good({"--config", file.c_str()});
  EXPECT_EQ(options.domain, 9U);
  EXPECT_EQ(options.rehearsal_fraction, 0.25);
  EXPECT_EQ(options.store, "/a \"place\"/x.db");
  EXPECT_EQ(options.backup_folder, "");
}

TEST_F(Options, TheSampleConfigurationIsThatOfTheDefaults) {
  const std::filesystem::path sample =
      std::filesystem::path(test::source_dir()) / "deploy/etc/kinshipd.toml";
  good({"--config", sample.c_str()});
  std::ifstream stream(sample);
  std::ostringstream lines;
  for (std::string line; std::getline(stream, line);)  // "#name = value": an option's default
    lines << (line.starts_with('#') && !line.starts_with("# ") ? line.substr(1) : line) << '\n';
  const test::TemporaryDirectory directory;
  const std::string file = (directory / "kinshipd.toml").string();
  std::ofstream(file) << lines.str();
  ASSERT_EQ(code({"--print-config"}), kDone);
  std::istringstream defaults(out_.str());
  ASSERT_EQ(code({"--config", file.c_str(), "--print-config"}), kDone) << err_.str();
  const std::string printed = out_.str();
  for (std::string line; std::getline(defaults, line);) {
    const bool is_of_the_machine = line.starts_with("store = ") || line.starts_with("workers = ");
    if (line.starts_with('#') || line.empty() || is_of_the_machine)
      continue;
    EXPECT_NE(printed.find('\n' + line + '\n'), std::string::npos) << line;
    EXPECT_NE(lines.str().find('\n' + line + '\n'), std::string::npos) << "sample lacks " << line;
  }
}

TEST_F(Options, TheHelpOfAVerbIsNotThatOfTheServer) {
  EXPECT_EQ(code({"check", "--help"}), kDone);
  EXPECT_NE(out_.str().find("kinshipd check --store fleet.db"), std::string::npos) << out_.str();
  EXPECT_EQ(out_.str().find("ready domain"), std::string::npos) << out_.str();
}

TEST_F(Options, AnEmptyStoreIsSaidToBeEmpty) {
  setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(code({"--store", ""}), kWrongUsage);
  EXPECT_NE(err_.str().find("--store is empty"), std::string::npos) << err_.str();
}

TEST_F(Options, ASiteNamesTheMemoryAboveIt) {
  const ServerOptions options =
      good({"--upstream", "postgresql://memory/kinship", "--upstream-tasks", "pick_*", "bin"});
  EXPECT_EQ(options.upstream, "postgresql://memory/kinship");
  EXPECT_EQ(options.upstream_tasks, (std::vector<std::string>{"pick_*", "bin"}));
  EXPECT_EQ(code({"--upstream", "fleet.db"}), kWrongUsage);
  EXPECT_NE(err_.str().find("postgresql://HOST/DATABASE"), std::string::npos) << err_.str();
  EXPECT_EQ(code({"--upstream-tasks", "pick_*"}), kWrongUsage) << "of what memory?";
  const char* const memory = "postgresql://memory/kinship";
  EXPECT_EQ(code({"--store", memory, "--upstream", memory}), kWrongUsage);
  EXPECT_NE(err_.str().find("same database as --store"), std::string::npos) << err_.str();
}

TEST_F(Options, WhatADatabasePromisesIsNotTakenForAFile) {
  for (const char* const option : {"--require-synchronous", "--primary-only"}) {
    EXPECT_EQ(code({"--store", "fleet.db", option}), kWrongUsage);
    EXPECT_NE(err_.str().find(std::string(option) +
                              " is for a PostgreSQL database, but --store 'fleet.db' is a file"),
              std::string::npos)
        << err_.str();
    EXPECT_EQ(good({"--store", "postgresql://db1/fleet", option}).store, "postgresql://db1/fleet");
  }
}

}  // namespace
}  // namespace kinship::app::options_test
