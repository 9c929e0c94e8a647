// Rules on the messages that idlc does not know.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/places.hpp"

namespace kinship::architecture::idl_test {
namespace {

namespace fs = std::filesystem;

/// The text of an IDL file without its comments.
std::string read_idl(const fs::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  return std::regex_replace(text.str(), std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
}

/// Members of structures whose type is another structure, not a sequence of it.
std::set<std::string> plain_structures(const std::string& idl) {
  const std::regex structure(R"(struct\s+(\w+)\s*\{)");
  std::set<std::string> names;
  for (std::sregex_iterator match(idl.begin(), idl.end(), structure), end; match != end; ++match)
    names.insert((*match)[1].str());
  const std::regex member(R"((?:^|[;{])\s*(?:@\w+\s+)*(\w+)\s+(\w+)\s*(?:\[\w+\])?(?=\s*;))");
  std::set<std::string> found;
  for (std::sregex_iterator match(idl.begin(), idl.end(), member), end; match != end; ++match)
    if (names.contains((*match)[1].str()))
      found.insert((*match)[2].str());
  return found;
}

TEST(Idl, PlainStructuresAreSeen) {
  EXPECT_EQ(plain_structures("struct A { long x; }; struct B { sequence<A, 1> many; A one; };"),
            std::set<std::string>{"one"});
  EXPECT_EQ(plain_structures("struct A { long x; };\nstruct B {\n  A first;\n  A pair[2];\n};"),
            (std::set<std::string>{"first", "pair"}));
}

TEST(Idl, NoStructureIsAPlainMemberOfAnother) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(test::source_dir()) / "proto/idl"))
    if (entry.path().extension() == ".idl") {
      ++files;
      for (const std::string& member : plain_structures(read_idl(entry.path())))
        ADD_FAILURE() << entry.path() << ": member " << member
                      << " is a structure: a message that ends before it aborts the reader";
    }
  EXPECT_GE(files, 5);
}

}  // namespace
}  // namespace kinship::architecture::idl_test
