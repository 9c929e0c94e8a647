#include "robots/geometry/srdf.hpp"

#include <gtest/gtest.h>

#include "proto/types/limits.hpp"

namespace kinship::geometry::srdf_test {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

kinematics::Chain three_links() {
  kinematics::ChainParts parts;
  parts.base_link = "base";
  parts.tip_link = "hand";
  parts.joints.resize(1);
  parts.joints[0].upper = 1;
  for (const char* name : {"base", "arm", "hand"})
    parts.links.push_back({name, -1, Eigen::Isometry3d::Identity(), -1});
  return kinematics::Chain(parts);
}

Result<Pairs> read(const std::string& text) { return read_srdf(text, three_links()); }

std::string message(const std::string& text) {
  const auto pairs = read(text);
  return pairs ? "fine" : pairs.error().message;
}

TEST(WriteSrdf, IsReadBackAndEscapesNames) {
  const std::string text =
      write_srdf("my <robot>", {{"hand", "arm", "Adjacent"}, {"base", "hand", "Never"}}, "a note");
  EXPECT_EQ(read(text).value_or_throw(), (Pairs{{"hand", "arm"}, {"base", "hand"}})) << text;
  EXPECT_NE(text.find("my &lt;robot&gt;"), std::string::npos) << text;
  EXPECT_NE(text.find("reason=\"Never\""), std::string::npos) << text;
}

TEST(WriteSrdf, ItsCommentEndsWhereItEnds) {
  const std::string text = write_srdf("r", {{"hand", "arm", "Never"}}, "of arm-->--- to hand-");
  EXPECT_EQ(read(text).value_or_throw(), (Pairs{{"hand", "arm"}})) << text;
  EXPECT_NE(text.find("<!-- of arm- ->- - - to hand- -->"), std::string::npos) << text;
}

TEST(ReadSrdf, GivesThePairsInTheirOrderAndNothingElse) {
  const auto pairs = read(R"(<?xml version="1.0"?>
    <!-- <disable_collisions link1="base" link2="base"/> -->
    <robot name="r">
      <group name="g"><disable_collisions link1="no" link2="matter"/></group>
      <disable_collisions link1="hand" link2="arm" reason="Adjacent"/>
      <link_sphere_approximation link="arm"/>
      <disable_collisions link1="base" link2="hand"/>
    </robot>)");
  ASSERT_TRUE(pairs) << pairs.error().message;
  EXPECT_EQ(*pairs, (Pairs{{"hand", "arm"}, {"base", "hand"}}));
}

TEST(ReadSrdf, ARobotWithoutPairsHasNone) {
  const auto pairs = read("<robot/>");
  ASSERT_TRUE(pairs);
  EXPECT_TRUE(pairs->empty());
}

TEST(ReadSrdf, LeavesOutPairsWithLinksThatTheRobotDoesNotHaveAndNamesThese) {
  std::vector<SrdfStranger> strangers;
  auto pairs = read_srdf(
      "<robot>\n<disable_collisions link1='arm' link2='camera'/>\n"
      "<disable_collisions link1='hand' link2='arm'/>\n"
      "<disable_collisions link1='lens' link2='camera'/></robot>",
      three_links(), &strangers);
  EXPECT_EQ(std::move(pairs).value_or_throw(), (Pairs{{"hand", "arm"}}));
  ASSERT_EQ(strangers.size(), 2U);
  EXPECT_EQ(strangers[0].link, "camera");
  EXPECT_EQ(strangers[0].line, 2);
  EXPECT_EQ(strangers[0].pairs, 2U);
  EXPECT_EQ(strangers[1].link, "lens");
  EXPECT_EQ(strangers[1].line, 4);
}

TEST(ReadSrdf, NamesTheLineOfWhatItRefuses) {
  EXPECT_EQ(message("<robot><disable_collisions link2='arm'/></robot>"),
            "line 1: disable_collisions has no link1");
  EXPECT_EQ(message("<urdf/>"), "no <robot> element");
  EXPECT_EQ(message("<robot>\n\n<disable_collisions"),
            "line 3: not well-formed XML: XML_ERROR_PARSING_ELEMENT");
  EXPECT_EQ(message(""), "line 0: not well-formed XML: XML_ERROR_EMPTY_DOCUMENT");
}

TEST(ReadSrdf, DoesNotExpandEntities) {
  std::string text = "<!DOCTYPE robot [<!ENTITY a0 'hand'>";
  for (int i = 1; i < 40; ++i)
    text += "<!ENTITY a" + std::to_string(i) + " '&a" + std::to_string(i - 1) + ";&a" +
            std::to_string(i - 1) + ";'>";
  text += "]><robot><disable_collisions link1='arm' link2='&a39;'/></robot>";
  std::vector<SrdfStranger> strangers;
  EXPECT_TRUE(read_srdf(text, three_links(), &strangers).value_or_throw().empty());
  ASSERT_EQ(strangers.size(), 1U);
  EXPECT_EQ(strangers[0].link, "&a39;");
}

TEST(ReadSrdf, RefusesNestingThatWouldUseUpTheStack) {
  std::string text;
  for (int i = 0; i < 100'000; ++i)
    text += "<robot>";
  EXPECT_EQ(message(text).find("line 1: not well-formed XML"), 0U) << message(text);
}

TEST(ReadSrdf, RefusesTooMuchBeforeItReadsIt) {
  const auto too_long = read(std::string(kMaxSrdfBytes + 1, ' '));
  ASSERT_FALSE(too_long);
  EXPECT_EQ(too_long.error().code, ErrorCode::TooLarge);
  EXPECT_EQ(too_long.error().message, "SRDF of 1000001 bytes exceeds 1000000");

  const std::string pair = "<disable_collisions link1='arm' link2='hand'/>";
  std::string many = "<robot>";
  for (std::size_t i = 0; i < kMaxCollisionPairs; ++i)
    many += pair;
  EXPECT_EQ(message(many + "</robot>"), "fine");
  EXPECT_EQ(message(many + pair + "</robot>"), "more than 4096 disable_collisions");
}

}  // namespace
}  // namespace kinship::geometry::srdf_test
