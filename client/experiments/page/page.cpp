#include "client/experiments/page/page.hpp"

#include <string>

#include "client/experiments/page/embedded_texts.hpp"
#include "client/experiments/page/page_json.hpp"
#include "client/page/document.hpp"

namespace kinship::experiments {

void write_page(const PageData& data, std::ostream& out) {
  page::Document document;
  document.title = "Kinship: what the fleet's experience was worth";
  document.body = page::text_of(page_texts(), "page.html");
  document.data = to_json(data);
  document.scripts = {page::text_of(page_texts(), "page.js")};
  document.draws_scenes = true;
  document.draws_charts = true;
  page::write_document(document, out);
}

}  // namespace kinship::experiments
