#include "client/experiments/page/page.hpp"

#include <string>

#include "client/experiments/page/embedded_texts.hpp"
#include "client/experiments/page/page_json.hpp"
#include "client/page/document.hpp"

namespace kinship::experiments {

void write_page(const PageData& data, std::ostream& out) {
  const auto text = [](std::string_view name) { return page::text_of(page_texts(), name); };
  page::Document document;
  document.title = "Kinship: what guidance was worth to " + data.robot;
  document.body = text("story.html");
  document.data = to_json(data);
  document.styles = {text("story.css")};
  document.scripts = {text("station.js"), text("searches.js"), text("story.js")};
  document.draws_scenes = true;
  document.draws_charts = true;
  page::write_document(document, out);
}

}  // namespace kinship::experiments
