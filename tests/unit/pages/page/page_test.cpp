#include "pages/page/document.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "pages/page/bones.hpp"
#include "pages/page/json_text.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::page::page_test {
namespace {

std::string written(const Document& document) {
  std::ostringstream out;
  write_document(document, out);
  return out.str();
}

Document document_of(const std::string& data) {
  Document document;
  document.title = "ur10e <in> \"words\" & more";
  document.body = "<h1 id=\"title\"></h1>";
  document.data = data;
  return document;
}

std::string data_in(const std::string& html) {
  const std::string begin = "id=\"data\">";
  const auto first = html.find(begin) + begin.size();
  return html.substr(first, html.find("</script>", first) - first);
}

TEST(Document, CarriesItsDataWhateverStandsInIt) {
  const std::string name = "</script><script>alert(1)</script><!--";
  const std::string html = written(document_of(nlohmann::json{{"name", name}}.dump()));
  EXPECT_EQ(nlohmann::json::parse(data_in(html))["name"], name);
}

TEST(Document, ItsTitleIsPlainText) {
  EXPECT_NE(written(document_of("{}")).find("<title>ur10e &lt;in&gt; &quot;words&quot; &amp; more"),
            std::string::npos);
}

TEST(Document, NeedsNothingElse) {
  Document document = document_of("{}");
  document.draws_scenes = document.draws_charts = true;
  const std::string html = written(document);
  EXPECT_NE(html.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(html.find("WebGLRenderer"), std::string::npos) << "three.js";
  EXPECT_NE(html.find("kinshipModules.add(\"vega-parser\""), std::string::npos);
  // An element that would load something; the programs in the page may speak of such.
  const std::regex loads("<(script|link|img|iframe|object|embed)\\b[^>]{0,200}\\b(src|href|data)=");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(html, found, loads)) << found.str();
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(html.find("'unsafe-eval'"), std::string::npos);
}

TEST(Document, CarriesOnlyTheProgramsItAsksFor) {
  EXPECT_LT(written(document_of("{}")).size(), 20'000U);
  Document document = document_of("{}");
  document.draws_scenes = true;
  const std::string html = written(document);
  EXPECT_NE(html.find("WebGLRenderer"), std::string::npos);
  EXPECT_EQ(html.find("vega-parser"), std::string::npos);
}

TEST(Document, AScriptThatWouldEndItsElementIsRefused) {
  Document document = document_of("{}");
  document.scripts = {"const html = '</script>';"};
  EXPECT_THROW(written(document), std::invalid_argument);
}

models::LoadedRobot load(const std::string& name) {
  models::RobotArguments arguments;
  arguments.source = std::filesystem::path(test::source_dir() + "/robots/models") / name;
  return models::load_robot(arguments).value_or_throw();
}

TEST(Bones, AreAsManyAsShapesAndMoveWithTheRobot) {
  const models::LoadedRobot robot = load("ur10e");
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(robot.chain.dof());
  const Eigen::Vector3d shift(1, 2, 3);
  const auto here = bones_of(robot, Eigen::Isometry3d::Identity(), q);
  const auto there = bones_of(robot, Eigen::Isometry3d(Eigen::Translation3d(shift)), q);
  ASSERT_EQ(here.size(), robot.shapes.shapes.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    EXPECT_TRUE((there[i].from - here[i].from).isApprox(shift));
    EXPECT_TRUE((there[i].to - here[i].to).isApprox(shift));
    EXPECT_GT(here[i].radius_m, 0);
    EXPECT_LT(here[i].from.norm(), 2.5);
  }
}

TEST(Bones, WhatIsHeldStaysInTheHand) {
  const models::LoadedRobot robot = load("ur10e");
  AttachedObject box;
  box.name = "box";
  box.link = robot.chain.tip_link();
  box.shape = BoxShape{{0.1, 0.2, 0.3}};
  box.T_link_object = Eigen::Translation3d(0, 0, 0.2);
  const Eigen::Isometry3d T_task_base(Eigen::Translation3d(1, 0, 0));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(robot.chain.dof(), 0.3);

  const auto held = held_objects(robot, {box}, T_task_base, q);

  ASSERT_EQ(held.size(), 1U);
  EXPECT_TRUE(held[0].T_task_object.isApprox(T_task_base * kinematics::T_base_tip(robot.chain, q) *
                                             box.T_link_object));
  box.link = "no such link";
  EXPECT_THROW(held_objects(robot, {box}, T_task_base, q), std::invalid_argument);
}

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
  object.shape = CapsuleShape{0.05, 0.6};
  EXPECT_EQ(json::parse(json_of(object))["capsule"], json({50, 600}));
  object.shape = SphereShape{0.25};
  EXPECT_EQ(json::parse(json_of(object))["sphere"], 250);
}

}  // namespace
}  // namespace kinship::page::page_test
