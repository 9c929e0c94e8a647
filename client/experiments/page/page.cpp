#include "client/experiments/page/page.hpp"

#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "client/experiments/page/embedded_texts.hpp"
#include "client/experiments/page/page_json.hpp"

namespace kinship::experiments {
namespace {

constexpr std::string_view kBegin = "<!--insert ";
constexpr std::string_view kEnd = "-->";

std::string_view embedded(std::string_view name) {
  for (const EmbeddedText& text : embedded_texts())
    if (text.name == name)
      return text.text;
  throw std::logic_error("write_page: no embedded text '" + std::string(name) + "'");
}

}  // namespace

void write_page(const PageData& data, std::ostream& out) {
  std::string_view page = embedded("page.html");
  for (auto place = page.find(kBegin); place != std::string_view::npos; place = page.find(kBegin)) {
    out << page.substr(0, place);
    page.remove_prefix(place + kBegin.size());
    const std::string_view name = page.substr(0, page.find(kEnd));
    page.remove_prefix(name.size() + kEnd.size());
    if (name == "data")
      out << to_json(data);
    else
      out << embedded(name);
  }
  out << page;
}

}  // namespace kinship::experiments
