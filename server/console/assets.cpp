#include "server/console/assets.hpp"

#include <algorithm>
#include <array>

#include "pages/page/document.hpp"
#include "pages/page/json_text.hpp"
#include "pages/plots/plot_pages.hpp"
#include "pages/plots/plot_texts.hpp"
#include "proto/types/sha256.hpp"
#include "server/console/app_texts.hpp"
#include "server/http/compression.hpp"

namespace kinship::console {
namespace {

constexpr std::string_view kShell = "shell.html";
constexpr std::array kStyles = {"page.css", "plots.css", "console.css"};
/// Those that every page needs, in the order in which they run.
constexpr std::array kScripts = {"page.js", "console.js",  "tables.js",  "series.js", "fleet.js",
                                 "slow.js", "listings.js", "figures.js", "start.js"};

std::string type_of(std::string_view name) {
  if (name.ends_with(".css"))
    return "text/css; charset=utf-8";
  if (name.ends_with(".svg"))
    return "image/svg+xml";
  return "text/javascript; charset=utf-8";
}

void replace(std::string& text, std::string_view mark, const std::string& with) {
  text.replace(text.find(mark), mark.size(), with);
}

/// All but what every page has.
std::vector<page::EmbeddedText> programs_of_figures() {
  std::vector<page::EmbeddedText> programs = plots::figure_programs();
  std::erase_if(programs, [](const page::EmbeddedText& each) { return each.name == "page.js"; });
  return programs;
}

}  // namespace

Assets::Assets() {
  for (const page::EmbeddedText& each : app_texts())
    if (each.name != kShell)
      add(each.name, each.text);
  for (const char* const name : {"page.css", "page.js"})
    add(name, page::text_of(page::embedded_texts(), name));
  add("plots.css", page::text_of(plots::plot_texts(), "plots.css"));
  for (const page::EmbeddedText& each : programs_of_figures())
    add(each.name, each.text);
}

void Assets::add(std::string_view name, std::string_view text) {
  assets_.push_back({std::string(name), text, http::gzip(text, http::Effort::Good), type_of(name),
                     Sha256().add(text).finish().short_hex()});
}

const Asset* Assets::find(std::string_view name) const {
  const auto found = std::ranges::find(assets_, name, &Asset::name);
  return found == assets_.end() ? nullptr : &*found;
}

std::string Assets::address_of(std::string_view name) const {
  const Asset* const asset = find(name);
  return "/assets/" + std::string(name) + "?v=" + (asset == nullptr ? "" : asset->version);
}

std::string Assets::shell(bool is_admin) const {
  std::string links, scripts;
  for (const char* const name : kStyles)
    links += "<link rel=\"stylesheet\" href=\"" + address_of(name) + "\">\n";
  for (const char* const name : kScripts)
    scripts += "<script src=\"" + address_of(name) + "\" defer></script>\n";
  const std::string figures = page::list(programs_of_figures(), [&](const auto& each) {
    return page::json_string(address_of(each.name));
  });
  std::string text(page::text_of(app_texts(), kShell));
  replace(text, "{{icon}}", address_of("icon.svg"));
  replace(text, "{{links}}", links + scripts);
  replace(text, "{{figures}}", page::escaped(figures));
  replace(text, "{{admin}}", is_admin ? "yes" : "no");
  return text;
}

}  // namespace kinship::console
