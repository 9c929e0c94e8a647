// Structures of the IDL that are written and read by the table of a value's fields have the same
// members, in the same order.

#include "proto/codec/fields.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "proto/types/conversations.hpp"
#include "proto/types/publications.hpp"
#include "tests/support/places.hpp"

namespace kinship::codec::fields_test {
namespace {

/// "uint64 paths", "sequence<8> costs" and so on: the members of a structure after its head, if
/// any.
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
  const std::regex member(R"((\w+)(?:<(\w+)(?:, (\w+))?>)?\s+([\w\[\]]+)\s*;)");
  for (std::sregex_iterator match(members.begin(), members.end(), member), end; match != end;
       ++match) {
    const std::string bound = (*match)[3].str(), name = (*match)[4].str();
    if (name != "client_id[16]" && name != "sequence_number")
      found.push_back((*match)[1].str() +
                      (bound.empty() || (*match)[2] == "string" ? "" : "<" + bound + ">") + " " +
                      name);
  }
  return found;
}

template <typename T>
std::string idl_type(std::size_t limit) {
  using Wire = typename WireMember<T>::Type;
  if (std::is_same_v<T, std::string>)
    return "string";
  if (std::is_same_v<T, Digest> || std::is_same_v<T, Uuid>)
    return "octet";
  if (std::is_same_v<Wire, dds_sequence_octet> || std::is_same_v<Wire, dds_sequence_double> ||
      std::is_same_v<Wire, dds_sequence_string>)
    return "sequence";
  if (kIsList<T> || (std::is_class_v<T> && !kIsDuration<T>))
    return "sequence<" + std::to_string(kIsList<T> ? limit : 1) + ">";
  if (std::is_same_v<Wire, bool>)
    return "boolean";
  if (std::is_same_v<Wire, double>)
    return "double";
  return (std::is_signed_v<Wire> ? "int" : "uint") + std::to_string(8 * sizeof(Wire));
}

template <Described Value>
std::vector<std::string> described() {
  std::vector<std::string> members;
  for_each_field<Value>([&]<typename Of, typename T>(const Field<Of, T>& field) {
    members.push_back(idl_type<T>(field.rules.limit) + " " + std::string(field.name) +
                      (std::is_same_v<T, Digest> ? "[32]"
                       : std::is_same_v<T, Uuid> ? "[16]"
                                                 : ""));
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

TEST(Fields, MessagesOfTheIdlHaveThemInTheirOrder) {
  EXPECT_EQ(described<RegisterReply>(), members_of("register.idl", "RegisterReply"));
  EXPECT_EQ(described<Receipt>(), members_of("report.idl", "Receipt"));
  EXPECT_EQ(described<ReportReply>(), members_of("report.idl", "ReportReply"));
  EXPECT_EQ(described<FetchReply>(), members_of("fetch.idl", "FetchReply"));
  EXPECT_EQ(described<AdminRequest>(), members_of("admin.idl", "AdminRequest"));
  EXPECT_EQ(described<Event>(), members_of("publication.idl", "Event"));
  EXPECT_EQ(described<FetchRequest>(), members_of("fetch.idl", "FetchRequest"));
  EXPECT_EQ(described<AdminReply>(), members_of("admin.idl", "AdminReply"));
  EXPECT_EQ(described<Announcement>(), members_of("publication.idl", "Announcement"));
}

TEST(Fields, ScoresSayKInFilesAndComponentsInMessages) {
  EXPECT_EQ(members_of("fetch.idl", "ComponentScore"),
            (std::vector<std::string>{"uint32 components", "double score"}));
  EXPECT_EQ(described<ComponentScore>(), (std::vector<std::string>{"uint32 K", "double score"}));
}

}  // namespace
}  // namespace kinship::codec::fields_test
