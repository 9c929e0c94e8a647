#include "pages/plots/plot_pages.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "proto/json/distribution_json.hpp"
#include "tests/unit/pages/plots/history_values.hpp"
#include "tests/unit/pages/plots/known_paths.hpp"
#include "tests/unit/pages/plots/plot_values.hpp"

namespace kinship::plots::plot_pages_test {
namespace {

using nlohmann::json;

template <typename... Plot>
std::string page_of(const Plot&... plot) {
  std::ostringstream page;
  write_page(plot..., page);
  return page.str();
}

/// The document that a page carries.
json data_of(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const auto first = page.find(begin) + begin.size();
  return json::parse(page.substr(first, page.find("</script>", first) - first));
}

DistributionFigure plot() {
  test::KnownPaths known;
  known.descriptions[kinship::test::model_chain("ur10e").digest()] =
      kinship::test::model_description("ur10e");
  return distribution_figure(test::distribution_for("ur10e"), known.look_up());
}

TEST(PlotPages, ADistributionIsThatOfFetchWithoutItsMixture) {
  const json data = data_of(page_of(plot()));
  json expected = json::parse(kinship::json::to_json(test::distribution_for("ur10e")));
  for (const char* const part : {"weights", "means", "covariances"})
    expected[part] = nullptr;
  EXPECT_EQ(data["distribution"], expected);
  EXPECT_EQ(data["mixture_size"], 2);
  EXPECT_EQ(data["components"], json::parse("[[0.75,0.75],[0.25,1]]"));
  EXPECT_EQ(data["hands"].size(), 3 * kSamplesShown);
  EXPECT_EQ(data["marginals"].size(), 6U);
  EXPECT_EQ(data["marginals"][0]["counts"].size(), kMarginalBins);
}

TEST(PlotPages, EqualPlotsAreEqualPages) { EXPECT_EQ(page_of(plot()), page_of(plot())); }

TEST(PlotPages, ATaskTellsItsHistory) {
  const json data =
      data_of(page_of(TaskFigure{history_of("shelf", test::season(12, 100, 300), {}), {}}));
  EXPECT_EQ(data["task"], "shelf");
  EXPECT_EQ(data["bin_ms"], 1000);
  EXPECT_EQ(data["robots"][0]["attempts"], 24);
  EXPECT_EQ(data["robots"][0]["bins"][0]["modes"][0]["median"], 100);
  EXPECT_EQ(data["robots"][0]["bins"][0]["modes"][1]["median"], nullptr);
  EXPECT_EQ(data["robots"][0]["benefit"].back()["control"], 12);
  EXPECT_EQ(data["space"]["paths"].size(), 0U);
}

TEST(PlotPages, AMatrixHasTheRowsOfCompare) {
  const Rehearsal rehearsal{.guide = Guide::Ways,
                            .is_complete = true,
                            .queries = 5,
                            .costs = {{Guide::None, 5, 5, 900, 900, 0.004},
                                      {Guide::Retreat, 5, 5, 600, 600, 0.003},
                                      {Guide::Ways, 5, 5, 300, 300, 0.002}}};
  const json data = data_of(page_of(
      std::string("shelf"),
      std::vector<Transferability>{{Digest{{1}}, Digest{{2}}, "arm1", "arm2", rehearsal, ""},
                                   {Digest{{1}}, Digest{{3}}, "arm1", "arm3", {}, "too late"}}));
  EXPECT_EQ(data["task"], "shelf");
  EXPECT_EQ(data["rows"][0]["worth"], 1.5);
  EXPECT_EQ(data["rows"][0]["worth_by_time"], 1.5);
  EXPECT_EQ(data["rows"][0]["worth_by_checks"], 2);
  EXPECT_EQ(data["rows"][0]["without_experience"], "retreat");
  EXPECT_EQ(data["rows"][0]["with_experience"], "ways");
  EXPECT_EQ(data["rows"][1]["worth"], nullptr);
  EXPECT_EQ(data["rows"][1]["message"], "too late");
}

}  // namespace
}  // namespace kinship::plots::plot_pages_test
