#include "pages/page/document.hpp"

#include <ostream>
#include <stdexcept>

#include "pages/page/embedded_text.hpp"

namespace kinship::page {
namespace {

constexpr std::string_view kHead = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy"
 content="default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:">
<title>)";

/// Vega's modules, each after the ones it asks for.
constexpr std::string_view kVegaParts[] = {
    "util",      "time",       "format",     "loader",          "statistics",     "dataflow",
    "scale",     "canvas",     "scenegraph", "expression",      "event-selector", "selection",
    "functions", "runtime",    "transforms", "view-transforms", "encode",         "view",
    "parser",    "interpreter"};

std::string_view embedded(std::string_view name) { return text_of(embedded_texts(), name); }

void write_element(std::string_view name, std::string_view text, std::ostream& out) {
  if (text.find("</" + std::string(name)) != std::string_view::npos)
    throw std::invalid_argument("write_document: a " + std::string(name) + " ends its own element");
  out << '<' << name << ">\n" << text << "\n</" << name << ">\n";
}

/// In JSON a '<' stands in strings only, and there it has another spelling.
void write_data(std::string_view json, std::ostream& out) {
  out << R"(<script type="application/json" id="data">)";
  for (const char c : json) {
    if (c == '<')
      out << "\\u003c";
    else
      out << c;
  }
  out << "</script>\n";
}

/// Vega's modules as one program, after modules.js.
const std::string& vega() {
  static const std::string kVega = [] {
    std::string program;
    for (const std::string_view part : kVegaParts) {
      const std::string name = "vega-" + std::string(part);
      program += "kinshipModules.add(\"" + name + "\", function (exports, module, require) {\n" +
                 std::string(embedded(name + ".min.js")) + "\n});\n";
    }
    return program;
  }();
  return kVega;
}

}  // namespace

std::string_view text_of(std::span<const EmbeddedText> texts, std::string_view name) {
  for (const EmbeddedText& text : texts)
    if (text.name == name)
      return text.text;
  throw std::logic_error("no embedded text '" + std::string(name) + "'");
}

std::vector<EmbeddedText> programs(bool draws_scenes, bool draws_charts) {
  std::vector<EmbeddedText> programs;
  const auto add = [&](std::string_view name) { programs.push_back({name, embedded(name)}); };
  add("page.js");
  if (draws_scenes)
    for (const char* name :
         {"three.min.js", "OrbitControls.js", "solids.js", "camera.js", "view.js", "player.js"})
      add(name);
  if (draws_charts) {
    add("modules.js");
    programs.push_back({"vega.js", vega()});
    add("charts.js");
  }
  return programs;
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

void write_document(const Document& document, std::ostream& out) {
  out << kHead << escaped(document.title) << "</title>\n";
  write_element("style", embedded("page.css"), out);
  for (const std::string_view style : document.styles)
    write_element("style", style, out);
  out << "</head>\n<body>\n<main>\n" << document.body << "\n</main>\n";
  write_data(document.data, out);
  for (const EmbeddedText& program : programs(document.draws_scenes, document.draws_charts))
    write_element("script", program.text, out);
  for (const std::string_view script : document.scripts)
    write_element("script", script, out);
  out << "</body>\n</html>\n";
}

}  // namespace kinship::page
