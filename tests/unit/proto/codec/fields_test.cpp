// Structures of the IDL that are written and read by the table of a value's fields have the same
// members, in the same order.

#include "proto/codec/fields.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "proto/types/distribution.hpp"
#include "proto/types/rehearsal.hpp"
#include "tests/support/places.hpp"

namespace kinship::codec::fields_test {
namespace {

/// "uint64 paths" and so on: the members of a structure.
std::vector<std::string> members_of(const std::string& file, const std::string& structure) {
  std::ifstream stream(test::source_dir() + "/proto/idl/" + file);
  std::stringstream text;
  text << stream.rdbuf();
  const std::string idl =
      std::regex_replace(text.str(), std::regex(R"(/\*[^*]*\*+([^/*][^*]*\*+)*/)"), "");
  std::smatch body;
  EXPECT_TRUE(
      std::regex_search(idl, body, std::regex("struct " + structure + R"(\s*\{([^}]*)\})")));
  const std::string members = body[1].str();
  std::vector<std::string> found;
  const std::regex member(R"((\w+(?:<[\w, ]+>)?)\s+([\w\[\]]+)\s*;)");
  for (std::sregex_iterator match(members.begin(), members.end(), member), end; match != end;
       ++match)
    found.push_back((*match)[1].str() + " " + (*match)[2].str());
  return found;
}

template <typename T>
std::string idl_type() {
  if (std::is_same_v<T, std::string>)
    return "string";
  if (std::is_same_v<T, Digest>)
    return "octet";
  if (std::is_same_v<T, std::optional<Digest>>)
    return "sequence<octet>";
  if (std::is_same_v<T, bool>)
    return "boolean";
  if (std::is_same_v<T, double>)
    return "double";
  return sizeof(T) == sizeof(std::uint64_t) ? "uint64" : "uint32";
}

template <Described Value>
std::vector<std::string> described() {
  std::vector<std::string> members;
  for_each_field<Value>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    members.push_back((kIsList<T> ? "sequence<GuideCost, " + std::to_string(field.rules.limit) + ">"
                                  : idl_type<T>()) +
                      " " + std::string(field.name) + (std::is_same_v<T, Digest> ? "[32]" : ""));
  });
  return members;
}

TEST(Fields, StructuresOfTheIdlHaveThemInTheirOrder) {
  EXPECT_EQ(described<Source>(), members_of("fetch.idl", "Source"));
  EXPECT_EQ(described<ModeEvidence>(), members_of("fetch.idl", "ArmEvidence"));
  EXPECT_EQ(described<JudgedAttempt>(), members_of("fetch.idl", "JudgedAttempt"));
  EXPECT_EQ(described<FitOrigin>(), members_of("fetch.idl", "FitOrigin"));
  EXPECT_EQ(described<GuideCost>(), members_of("fetch.idl", "GuideCost"));
  EXPECT_EQ(described<Rehearsal>(), members_of("fetch.idl", "Rehearsal"));
  EXPECT_EQ(described<PlanningRecord>(), members_of("report.idl", "PlanningRecord"));
}

TEST(Fields, ScoresSayKInFilesAndComponentsInMessages) {
  EXPECT_EQ(members_of("fetch.idl", "ComponentScore"),
            (std::vector<std::string>{"uint32 components", "double score"}));
  EXPECT_EQ(described<ComponentScore>(), (std::vector<std::string>{"uint32 K", "double score"}));
}

}  // namespace
}  // namespace kinship::codec::fields_test
