#include "robots/kinematics/urdf_markup.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/types/limits.hpp"

namespace kinship::kinematics::urdf_markup_test {
namespace {

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i)
    all += text;
  return all;
}

std::string message(const std::string& text) {
  const auto error = check_markup(text);
  return error ? error->message : "fine";
}

TEST(UrdfMarkup, AcceptsWhatDescriptionsContain) {
  EXPECT_EQ(message("<?xml version=\"1.0\"?>\n<!-- a < b, </robot> -->\n<robot name = 'r'>\r\n\t"
                    "<link name='a>b'/><gazebo><![CDATA[ <x> ]]></gazebo></robot>\n"),
            "fine");
}

TEST(UrdfMarkup, RefusesEmptyAndTooLongText) {
  EXPECT_EQ(message(""), "URDF: text is empty");
  const auto error = check_markup(std::string(kMaxUrdfBytes + 1, ' '));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::TooLarge);
  EXPECT_EQ(error->message, "URDF: 1000001 bytes exceed 1000000");
  EXPECT_FALSE(check_markup(std::string(kMaxUrdfBytes, ' ')));
}

TEST(UrdfMarkup, RefusesDocumentTypesAndSoEntityBombs) {
  EXPECT_EQ(message("<?xml version='1.0'?>\n<!DOCTYPE r [<!ENTITY a 'aaaa'>"
                    "<!ENTITY b '&a;&a;'>]><robot>&b;</robot>"),
            "URDF: line 2: document types and entities are not accepted");
}

TEST(UrdfMarkup, RefusesDeepNestingHoweverItIsHidden) {
  EXPECT_EQ(message(repeated("<a>", kMaxUrdfDepth)), "fine");
  EXPECT_EQ(message(repeated("<a>", kMaxUrdfDepth + 1)), "URDF: 65 nested elements exceed 64");
  for (const std::string hidden :
       {"<!-- </a> -->", "<![CDATA[</a>]]>", "<b c='/'/>", "<b c=\"'\"/>", "</a><a><a>"})
    EXPECT_NE(message(repeated("<a>" + hidden, 100)).find("nested"), std::string::npos) << hidden;
  for (const std::string hidden : {"<?xml </a> ?>", "<b c='</a>'/>", "<b </a>"})
    EXPECT_NE(message(repeated("<a>" + hidden, 100)), "fine") << hidden;
}

TEST(UrdfMarkup, RefusesTooManyAttributesAndLinks) {
  EXPECT_NE(message("<a " + repeated("b='' ", kMaxUrdfAttributes + 1) + "/>").find("65 attributes"),
            std::string::npos);
  EXPECT_NE(message("<a b=1/>").find("without quotes"), std::string::npos);
  EXPECT_EQ(message(repeated("<link name='a'/>", kMaxUrdfLinks)), "fine");
  EXPECT_EQ(message(repeated("<link/>", kMaxUrdfLinks + 1)), "URDF: 1025 links exceed 1024");
}

TEST(UrdfMarkup, NamesTheLineOfWhatDoesNotEnd) {
  EXPECT_EQ(message("<a>\n\n<!-- "), "URDF: line 3: '<!--' without '-->'");
  EXPECT_EQ(message("<a>\n<b c='1"), "URDF: line 2: an attribute whose quote does not end");
  EXPECT_EQ(message("<a></a></a>"), "URDF: line 1: an end tag without its start tag");
  EXPECT_EQ(message("<a"), "URDF: line 1: '<' without the name of an element");
  EXPECT_EQ(message("< "), "URDF: line 1: '<' without the name of an element");
}

TEST(UrdfMarkup, RefusesControlCharacters) {
  EXPECT_EQ(message(std::string("<a\0/>", 5)), "URDF: byte 3 is a control character");
}

TEST(UrdfMarkup, OnlyBlanksWithinQuotesOfTagsAreNormalized) {
  EXPECT_EQ(normalize_attributes("<a\n b='1\t2\n3' c=\"'\t'\">\t'\n'</a>"),
            "<a\n b='1 2 3' c=\"' '\">\t'\n'</a>");
  EXPECT_EQ(normalize_attributes("<!-- b='1\t2' --><a b='>\t'/>"), "<!-- b='1\t2' --><a b='> '/>");
  EXPECT_EQ(normalize_attributes("<![CDATA[<a b='1\t2'/>]]>\n<c d='\n'/>"),
            "<![CDATA[<a b='1\t2'/>]]>\n<c d=' '/>");
}

TEST(UrdfMarkup, AroundNumbersNothingStays) {
  EXPECT_EQ(normalize_attributes("<a b=' 0.1\t' c=\"\n-1 2e-3\t+3 \" d='1'/>"),
            "<a b='0.1' c=\"-1 2e-3 +3\" d='1'/>");
  EXPECT_EQ(normalize_attributes("<a b=' arm ' c=' ' d=''/>text ' 1 '<e/>"),
            "<a b=' arm ' c=' ' d=''/>text ' 1 '<e/>");
}

}  // namespace
}  // namespace kinship::kinematics::urdf_markup_test
