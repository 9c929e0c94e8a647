#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "tests/architecture/edges.hpp"
#include "tests/support/places.hpp"

namespace kinship::architecture::include_direction_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = test::source_dir();
const std::vector<std::string> kRoofs = {"proto", "robots", "pages", "server", "client"};

struct Include {
  std::string file;  // relative to the repository root
  std::string target;
  bool quoted = false;
};

bool is_source(const fs::path& file) {
  return file.extension() == ".hpp" || file.extension() == ".cpp";
}

std::vector<Include> read_includes(const fs::path& file) {
  static const std::regex kPattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
  std::vector<Include> includes;
  std::ifstream stream(file);
  std::string line;
  std::smatch match;
  while (std::getline(stream, line))
    if (std::regex_search(line, match, kPattern))
      includes.push_back({fs::relative(file, kRoot).string(), match[2].str(), match[1] == "\""});
  return includes;
}

std::vector<Include> all_includes() {
  std::vector<Include> includes;
  for (const std::string& roof : kRoofs)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / roof))
      if (entry.is_regular_file() && is_source(entry.path()))
        std::ranges::copy(read_includes(entry.path()), std::back_inserter(includes));
  return includes;
}

/// The folder of `kAllowedEdges` that a path lies in; empty if none does.
std::string library_of(const std::string& path) {
  for (const auto& [folder, edges] : kAllowedEdges)
    if (path.starts_with(folder + "/"))
      return folder;
  return {};
}

std::string external_library_of(const std::string& target) {
  for (const auto& [name, prefixes] : kExternalLibraries)
    for (const std::string& prefix : prefixes)
      if (target.starts_with(prefix))
        return name;
  return {};
}

TEST(Architecture, EverySourceLiesInAKnownLibrary) {
  for (const Include& include : all_includes())
    EXPECT_NE(library_of(include.file), "") << include.file << " is in no library of edges.hpp";
}

TEST(Architecture, LibrariesIncludeOnlyWhatTheirRowAllows) {
  for (const Include& include : all_includes()) {
    const std::string from = library_of(include.file);
    const std::string to = library_of(include.target);
    if (from.empty() || from == to || (to.empty() && !include.quoted))
      continue;
    EXPECT_TRUE(kAllowedEdges.at(from).libraries.contains(to))
        << include.file << " includes " << include.target << ": " << from << " may not use '" << to
        << "'";
  }
}

TEST(Architecture, ExternalLibrariesStayInTheirRooms) {
  for (const Include& include : all_includes()) {
    const std::string from = library_of(include.file);
    const std::string external = external_library_of(include.target);
    if (external.empty() || from.empty())
      continue;
    EXPECT_TRUE(kAllowedEdges.at(from).external.contains(external))
        << include.file << " includes <" << include.target << ">: " << external << " is not for "
        << from;
  }
}

/// The place of a path's room in kStoreRooms; their number for the folder itself, -1 elsewhere.
int place_in_store(const std::string& path) {
  const std::string folder = "server/store/sqlite/";
  if (!path.starts_with(folder))
    return -1;
  const std::string room =
      path.substr(folder.size(), path.find('/', folder.size()) - folder.size());
  return static_cast<int>(std::ranges::find(kStoreRooms, room) - kStoreRooms.begin());
}

TEST(Architecture, RoomsOfTheStoreLeanOnThoseBeforeThem) {
  for (const Include& include : all_includes()) {
    const int from = place_in_store(include.file);
    if (from < 0)
      continue;
    EXPECT_LE(place_in_store(include.target), from)
        << include.file << " includes " << include.target;
  }
}

/// Of server/store the files of a room may include what is allowed alone, and no engine at all.
void expect_no_engine(const std::string& room, const std::set<std::string>& allowed) {
  for (const Include& include : all_includes()) {
    if (!include.file.starts_with(room))
      continue;
    if (include.target.starts_with("server/store/")) {
      EXPECT_TRUE(std::ranges::any_of(
          allowed, [&](const std::string& each) { return include.target.starts_with(each); }))
          << include.file << " includes " << include.target;
    }
    const std::string external = external_library_of(include.target);
    EXPECT_TRUE(external != "SQLite" && external != "libpq")
        << include.file << " includes " << include.target;
  }
}

TEST(Architecture, ValuesRulesAndTablesOfTheStoreKnowNoEngine) {
  expect_no_engine("server/store/values/", kStoreForValues);
  expect_no_engine("server/store/rules/", kStoreForRules);
  expect_no_engine("server/store/tables/", kStoreForTables);
}

TEST(Architecture, FilesStayReadable) {
  constexpr std::ptrdiff_t kMaxLines = 500;
  std::vector<std::string> roofs = kRoofs;
  roofs.emplace_back("tests");
  for (const std::string& roof : roofs)
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / roof)) {
      if (!entry.is_regular_file() || !is_source(entry.path()))
        continue;
      std::ifstream stream(entry.path());
      const auto lines = std::count(std::istreambuf_iterator<char>(stream), {}, '\n');
      EXPECT_LE(lines, kMaxLines) << entry.path() << ": look for the second noun in it";
    }
}

TEST(Architecture, EveryLibraryExplainsItself) {
  for (const auto& [folder, edges] : kAllowedEdges)
    EXPECT_TRUE(fs::exists(kRoot / folder / "README.md")) << folder << " has no README.md";
}

}  // namespace
}  // namespace kinship::architecture::include_direction_test
