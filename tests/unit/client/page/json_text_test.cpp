#include "client/page/json_text.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace kinship::page::json_text_test {
namespace {

using nlohmann::json;

TEST(JsonText, ATextIsWhatItWas) {
  const std::string text = "\"quoted\" \\ line\nbreak \x01 \xc3\xa4";
  EXPECT_EQ(json::parse(json_string(text)), text);
}

TEST(JsonText, WhatJsonCannotSayIsNull) {
  EXPECT_EQ(number(0.25), "0.25");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(number(std::numeric_limits<double>::quiet_NaN()), "null");
}

TEST(JsonText, LengthsAreWholeMillimetresColumnAfterColumn) {
  Eigen::Matrix3Xd points(3, 2);
  points << 1, 4, 2, 5, 3, 6.0004;
  EXPECT_EQ(json::parse(millimetres(points)), json({1000, 2000, 3000, 4000, 5000, 6000}));
}

TEST(JsonText, EachSolidHasItsSize) {
  SceneObject object{"post", CylinderShape{0.05, 0.6}, Eigen::Isometry3d::Identity()};
  EXPECT_EQ(json::parse(json_of(object))["cylinder"], json({50, 600}));
  EXPECT_EQ(json::parse(json_of(object))["pose"], json({0, 0, 0, 0, 0, 0, 1}));
  object.shape = BoxShape{{0.1, 0.2, 0.3}};
  EXPECT_EQ(json::parse(json_of(object))["box"], json({100, 200, 300}));
  object.shape = SphereShape{0.25};
  EXPECT_EQ(json::parse(json_of(object))["sphere"], 250);
}

}  // namespace
}  // namespace kinship::page::json_text_test
