// A page with one figure and one chart, made of a real arm, as the tests of view.js look at it.

#include <iostream>

#include "pages/page/bones.hpp"
#include "pages/page/document.hpp"
#include "pages/page/json_text.hpp"
#include "robots/models/loaded_robot.hpp"
#include "tests/support/places.hpp"

namespace {

constexpr std::string_view kScript = R"js(
const {data, byId} = kinshipPage;
window.sample = kinshipView.show(byId("view"), {label: "An arm before a post", from: [-1, -1.4, 0.8], layers: [
  {name: "scene", text: "post", color: "scene", objects: data.scene},
  {name: "arm", text: "arm", color: "robot-0", arms: [{bones: data.arm}]},
  {name: "cloud", text: "cloud", color: "goal", points: [{positions: [0.6, 0.4, 0.9, 0.5, -0.6, 0.2], size: 0.1, opacity: 1}]},
  {name: "way", text: "way", color: "held", ways: [{positions: [0.5, -0.5, 0.3, 0.6, 0, 0.9, 0.5, 0.5, 0.3], width: 0.03}]}]});
kinshipCharts.show(byId("chart"), "One bar", (width) => ({
  width, height: 60, data: [{name: "rows", values: [{n: 3}]}],
  scales: [{name: "x", domain: [0, 4], range: "width"}],
  marks: [{type: "rect", from: {data: "rows"}, encode: {update: {
    x: {scale: "x", value: 0}, x2: {scale: "x", field: "n"}, y: {value: 10}, height: {value: 30},
    fill: {value: kinshipPage.color("guided")}}}}]}));
)js";

}  // namespace

int main() {
  kinship::models::RobotArguments arguments;
  arguments.source = kinship::test::source_dir() + "/robots/models/panda";
  const auto robot = kinship::models::load_robot(arguments).value_or_throw();
  const Eigen::VectorXd q = 0.5 * (robot.chain.lower() + robot.chain.upper());
  const kinship::Scene scene{{{"post", kinship::BoxShape{{0.1, 0.1, 1}},
                               Eigen::Isometry3d(Eigen::Translation3d(0.7, -0.7, 0.5))}}};
  kinship::page::Document page;
  page.title = "sample";
  page.body =
      "<section><figure id=\"view\"></figure></section><section><figure "
      "id=\"chart\"></figure></section>"
      "<section style=\"height: 2000px\"></section>";
  page.data =
      "{\"scene\":" + kinship::page::json_of(scene.objects) + ",\"arm\":" +
      kinship::page::json_of(kinship::page::bones_of(robot, Eigen::Isometry3d::Identity(), q)) +
      "}";
  page.scripts = {kScript};
  page.draws_scenes = page.draws_charts = true;
  kinship::page::write_document(page, std::cout);
}
