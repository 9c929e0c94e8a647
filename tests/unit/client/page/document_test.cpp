#include "client/page/document.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

namespace kinship::page::document_test {
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

}  // namespace
}  // namespace kinship::page::document_test
