// Kinship installed, and client/examples built against it as a project of its own and run beside a
// server.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::installed_library_test {
namespace {

namespace fs = std::filesystem;

struct Ended {
  int exit_code = -1;
  std::string output;
};

Ended run(const std::vector<std::string>& command) {
  test::ChildProcess process(command);
  Ended ended;
  for (std::string line = process.read_line(); !line.empty(); line = process.read_line())
    ended.output += line + '\n';
  ended.exit_code = process.wait();
  return ended;
}

/// Its empty lines do not end the output.
Ended run_in_shell(const std::string& command) {
  return run({"/bin/sh", "-c", "{ " + command + "; } 2>&1 | sed 's/^$/ /'"});
}

const fs::path kBuild = fs::path(test::bin_dir()).parent_path();
// Always the same one, so that a compiler cache knows the examples.
const fs::path kFolder = kBuild / "tests" / "installed_library";
const fs::path kPrefix = kFolder / "prefix";
/// Major and minor version, which may change interfaces.
const std::string kInterface =
    std::string(KINSHIP_VERSION).substr(0, std::string(KINSHIP_VERSION).rfind('.'));
const std::string kExamples = test::source_dir() + "/client/examples/";

/// Every file that a header names in quotes is installed with it, so none needs our source tree.
void expect_headers_are_complete(const fs::path& root) {
  static const std::regex kInclude(R"re(^\s*#\s*include\s*"([^"]+)")re");
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file())
      continue;
    std::ifstream stream(entry.path());
    std::smatch match;
    for (std::string line; std::getline(stream, line);)
      if (std::regex_search(line, match, kInclude)) {
        ++count;
        EXPECT_TRUE(fs::exists(root / match[1].str()))
            << entry.path() << " includes " << match[1] << ", which is not installed";
      }
  }
  EXPECT_GT(count, 100);
}

class InstalledLibrary : public testing::Test {
 protected:
  InstalledLibrary() {
    setenv("KINSHIP_DOMAIN", std::to_string(domain_.number()).c_str(), 1);
    setenv("XDG_STATE_HOME", directory_.path().c_str(), 1);
    unsetenv("KINSHIP_SERVER");
  }

  /// Then it is moved: nothing in it may say where it was.
  static void install() {
    const fs::path elsewhere = kFolder / "elsewhere";
    fs::remove_all(kPrefix);
    fs::remove_all(elsewhere);
    for (const std::string component : {"client", "planning", "c", "robots"}) {
      const Ended installed = run({KINSHIP_CMAKE, "--install", kBuild.string(), "--prefix",
                                   elsewhere.string(), "--component", component});
      ASSERT_EQ(installed.exit_code, 0) << installed.output;
    }
    fs::rename(elsewhere, kPrefix);
  }
  /// What find_package with these arguments says in a project that needs no compiler.
  static Ended find_kinship(const std::string& arguments) {
    const fs::path project = kFolder / "finds";
    fs::remove_all(project);
    fs::create_directories(project);
    std::ofstream(project / "CMakeLists.txt")
        << "cmake_minimum_required(VERSION 3.25)\nproject(finds LANGUAGES NONE)\n"
        << "find_package(Kinship " << arguments << ")\n"
        << "message(STATUS \"found ${Kinship_VERSION}: ${Kinship_FOUND}\")\n";
    return run_in_shell(std::string(KINSHIP_CMAKE) + " -G '" KINSHIP_GENERATOR "' -S '" +
                        project.string() + "' -B '" + (project / "build").string() +
                        "' -DCMAKE_PREFIX_PATH='" + kPrefix.string() + "'");
  }
  static void expect_said(const Ended& run, const std::string& part) {
    // CMake breaks its lines between words.
    const std::string said = std::regex_replace(run.output, std::regex("\\s+"), " ");
    EXPECT_NE(said.find(part), std::string::npos) << "no '" << part << "' in: " << run.output;
  }
  static void build_examples() {
    const std::string source = test::source_dir() + "/client/examples";
    const std::string build = (kFolder / "build").string();
    const std::string flags =
        " -DCMAKE_BUILD_TYPE= -DCMAKE_CXX_FLAGS='-O0 -Wall -Wextra -Werror'"
        " -DCMAKE_C_FLAGS='-Wall -Wextra -Wpedantic -Werror'";
    fs::remove_all(build);
    // sed is the last of the pipe: what cmake says decides.
    const Ended built = run_in_shell(
        std::string(KINSHIP_CMAKE) + " -G '" KINSHIP_GENERATOR "' -S '" + source + "' -B '" +
        build + "' -DCMAKE_PREFIX_PATH='" + kPrefix.string() + "'" + flags +
        KINSHIP_LAUNCHERS " && " KINSHIP_CMAKE " --build '" + build + "' && echo BUILT");
    ASSERT_NE(built.output.find("\nBUILT\n"), std::string::npos) << built.output;
  }
  void start_server() {
    server_ = std::make_unique<test::ServerProcess>(
        test::ServerProcess::Options{.store = directory_ / "fleet.db", .domain = domain_.number()});
  }
  static std::vector<std::string> example(const std::string& name,
                                          std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), (kFolder / "build" / name).string());
    return arguments;
  }
  static void expect_output(const Ended& run, const std::string& part) {
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_NE(run.output.find(part), std::string::npos) << "no '" << part << "' in: " << run.output;
  }

  /// Programs that follow: one revision is there, another comes of what is reported then.
  static void expect_two_revisions(const std::vector<std::string>& names,
                                   const std::string& models) {
    std::vector<std::unique_ptr<test::ChildProcess>> following;
    std::vector<std::string> first;
    for (const std::string& name : names) {
      following.push_back(std::make_unique<test::ChildProcess>(example(name, {models, "2"})));
      first.push_back(following.back()->read_line());
      EXPECT_TRUE(first.back().starts_with("revision ")) << name << ": " << first.back();
    }
    expect_output(run(example("01_report_a_path", {models, "6"})), "accepted 6");
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string second = following[i]->read_line();
      EXPECT_TRUE(second.starts_with("revision ")) << names[i] << ": " << second;
      EXPECT_NE(second, first[i]) << names[i];
      EXPECT_EQ(following[i]->wait(), 0) << names[i];
    }
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
};

TEST_F(InstalledLibrary, ExamplesAreBuiltAgainstItAndRunBesideAServer) {
  ASSERT_NO_FATAL_FAILURE(install());
  expect_headers_are_complete(kPrefix / "include" / ("kinship-" + kInterface));
  ASSERT_NO_FATAL_FAILURE(build_examples());
  expect_said(find_kinship(kInterface + " REQUIRED COMPONENTS c"), "found " KINSHIP_VERSION ": 1");
  expect_said(find_kinship(kInterface + " REQUIRED COMPONENTS c OPTIONAL_COMPONENTS nonsense"),
              ": 1");
  expect_said(find_kinship("REQUIRED COMPONENTS nonsense"),
              "component 'nonsense' is not installed beside");
  expect_said(find_kinship("REQUIRED COMPONENTS nonsense"), "(known are client, planning, c)");
  expect_said(find_kinship("0.99 REQUIRED"), "requested version \"0.99\"");
  expect_said(find_kinship("0.0.9 REQUIRED"), "requested version \"0.0.9\"");
  const std::string models = (kPrefix / "share/kinship/robots").string();

  const Ended offline = run(example("07_work_offline", {models}));
  expect_output(offline, "planning uniformly");
  expect_output(offline, "accepted 0, pending 1");
  start_server();
  expect_output(run(example("07_work_offline", {models})), "accepted 2, pending 0");

  expect_output(run(example("01_report_a_path", {models, "0"})),
                "accepted 6, refused 0, pending 0");
  expect_output(run(example("01_report_a_path_c", {models + "/panda/robot.urdf"})), "accepted 1");
  expect_output(run(example("02_fetch_and_sample", {models})), "paths of 'panda'\ndrawn 1000");
  expect_output(run(example("02_fetch_and_sample_c", {models + "/ur10e/robot.urdf"})),
                "of 6 joints");
  expect_output(run({KINSHIP_PYTHON, kExamples + "02_fetch_and_sample_ctypes.py",
                     (kPrefix / KINSHIP_LIBDIR / "libkinship.so").string(), models}),
                "1000 samples of 6 joints");
  expect_output(run(example("03_guide_an_ompl_planner", {models})), "solved with ");
  expect_output(run(example("04_guide_your_own_planner", {models})), "solved in ");
  expect_output(run(example("04_guide_your_own_planner_c", {models})), "arrays hold the rows: yes");
  expect_output(run(example("08_plan_as_kinship_plan", {models})), "post 3 solved with ");
  // Recalled, or not where a search is cheaper: by the paths that the server made.
  expect_output(run(example("09_recall_in_ompl", {models})), "ed with ");
  expect_output(run(example("09_recall_a_path_c", {models})), " waypoints after ");
  expect_output(run(example("06_register_any_urdf",
                            {models + "/iiwa7/robot.urdf", "iiwa_link_0", "iiwa_link_ee", "0.12"})),
                "inverse kinematics: ");

  expect_two_revisions({"05_follow_and_replan", "05_follow_and_replan_c"}, models);
}

TEST(CLibrary, ExportsWhatItsHeaderDeclaresAndNothingElse) {
  const std::string header = test::read_text(test::source_dir() + "/client/c/kinship.h") +
                             test::read_text(test::source_dir() + "/client/c/kinship_planning.h");
  static const std::regex kDeclared(R"(KINSHIP_API [^;(]*?(kinship_\w+)\()");
  std::vector<std::string> declared = {"dds_security_timed_dispatcher_add", "dds_time",
                                       "ddsi_new_proxy_reader", "ddsi_new_proxy_writer",
                                       "ddsrt_cond_waituntil"};  // in front of Cyclone DDS's
  for (std::sregex_iterator it(header.begin(), header.end(), kDeclared), end; it != end; ++it)
    declared.push_back((*it)[1]);
  std::ranges::sort(declared);
  EXPECT_GT(declared.size(), 20U);

  const Ended symbols = run({"/usr/bin/nm", "-D", "--defined-only", "--without-symbol-versions",
                             "--format=posix", KINSHIP_C_LIBRARY});
  ASSERT_EQ(symbols.exit_code, 0) << symbols.output;
  std::vector<std::string> exported;
  std::istringstream lines(symbols.output);
  for (std::string line; std::getline(lines, line);)
    if (const std::string name = line.substr(0, line.find(' ')); name != "KINSHIP_0")
      exported.push_back(name);
  std::ranges::sort(exported);
  EXPECT_EQ(exported, declared);
}

TEST(CLibrary, LoadsNoLibraryThatRosBringsInAnotherBuild) {
  const std::string library = KINSHIP_C_LIBRARY;
  const Ended needed = run_in_shell("readelf --dynamic --wide " + library);
  ASSERT_EQ(needed.exit_code, 0) << needed.output;
  EXPECT_NE(needed.output.find("Shared library: [libddsc"), std::string::npos) << needed.output;
  for (const char* other : {"[libompl", "[libboost"})
    EXPECT_EQ(needed.output.find(other), std::string::npos) << other << " in " << needed.output;
  const Ended unused = run_in_shell("ldd -u " + library);
  EXPECT_EQ(unused.output, "") << "loaded for nothing";
}

TEST(CLibrary, AloneIsFoundByPkgConfigAndByOtherCompilersAndFlags) {
  const std::string prefix = (kBuild / "tests" / "c_library").string();
  fs::remove_all(prefix);
  const Ended installed =
      run({KINSHIP_CMAKE, "--install", kBuild.string(), "--prefix", prefix, "--component", "c"});
  ASSERT_EQ(installed.exit_code, 0) << installed.output;
  const std::string environment =
      "export PKG_CONFIG_PATH=\"$(dirname \"$(find '" + prefix + "' -name kinship.pc)\")\" && " +
      "export LD_LIBRARY_PATH=\"$(pkg-config --variable=prefix kinship)/" KINSHIP_LIBDIR "\" && ";
  const std::string program = prefix + "/program";
  const auto build_and_run = [&](const std::string& compiler, const std::string& source) {
    return run_in_shell(environment + compiler + " '" + source + "' $(pkg-config --cflags --libs " +
                        "kinship) -o '" + program + "' && '" + program + "'")
        .output;
  };
  const std::string in_c = kExamples + "01_report_a_path_c.c";
  const std::string usage = "usage: 01_report_a_path_c URDF\n";
  EXPECT_EQ(build_and_run("cc -std=c99 -pedantic -fno-exceptions -m64 -Wall -Werror", in_c), usage);
  if (fs::exists("/usr/bin/clang")) {
    EXPECT_EQ(build_and_run("clang -std=c11 -O2 -march=native -fshort-enums -Wall -Werror", in_c),
              usage);
  }
  // C++ whose standard library, exceptions and alignment are not those that the library has.
  const std::string in_cpp = prefix + "/other_abi.cpp";
  std::ofstream(in_cpp) << "#include <kinship.h>\n#include <cstdio>\n#include <string>\n"
                        << "static_assert(!_GLIBCXX_USE_CXX11_ABI);\n"
                        << "int main() {\n  kinship_attempt attempt{};\n"
                        << "  const int code = kinship_report(nullptr, &attempt);\n"
                        << "  const std::string text = kinship_error_text();\n"
                        << "  std::printf(\"%d %s\\n\", code, text.c_str());\n}\n";
  EXPECT_EQ(build_and_run("c++ -std=c++14 -D_GLIBCXX_USE_CXX11_ABI=0 -fno-exceptions -fno-rtti "
                          "-O3 -march=native -Wall -Wextra -Werror",
                          in_cpp),
            "1 client is NULL\n");
}

TEST(AddSubdirectory, OffersTheSameTargetsWithoutTests) {
  const fs::path folder = kBuild / "tests" / "added_library";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::ofstream(folder / "CMakeLists.txt")
      << "cmake_minimum_required(VERSION 3.25)\nproject(theirs LANGUAGES C CXX)\n"
      << "add_subdirectory([[" << test::source_dir() << "]] kinship EXCLUDE_FROM_ALL)\n"
      << "foreach(name IN ITEMS client planning c)\n"
      << "  add_executable(uses_${name} main.cpp)\n"
      << "  target_link_libraries(uses_${name} PRIVATE Kinship::${name})\nendforeach()\n"
      << "if(TARGET unit_types OR TARGET GTest::gtest)\n  message(FATAL_ERROR tests)\nendif()\n";
  std::ofstream(folder / "main.cpp") << "int main() { return 0; }\n";
  const Ended configured = run_in_shell(
      std::string(KINSHIP_CMAKE) + " -G '" KINSHIP_GENERATOR "' -S '" + folder.string() + "' -B '" +
      (folder / "build").string() + "' -DCMAKE_EXPORT_COMPILE_COMMANDS=ON && echo CONFIGURED");
  ASSERT_NE(configured.output.find("\nCONFIGURED\n"), std::string::npos) << configured.output;
  // A line each for the command and the file of a source.
  std::istringstream lines(test::read_text(folder / "build" / "compile_commands.json"));
  int theirs = 0;
  for (std::string line; std::getline(lines, line);)
    if (line.find("\"command\"") != std::string::npos &&
        line.find(" -c " + (folder / "main.cpp").string()) != std::string::npos) {
      ++theirs;
      EXPECT_EQ(line.find("-Wconversion"), std::string::npos) << line;
    }
  EXPECT_EQ(theirs, 3);
}

}  // namespace
}  // namespace kinship::installed_library_test
