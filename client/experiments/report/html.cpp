#include "client/experiments/report/html.hpp"

namespace kinship::experiments::html {
namespace {

constexpr std::string_view kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1c2733; max-width: 75rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; } h2 { margin-top: 2.5rem; border-bottom: 1px solid #ccd3da; }
table { border-collapse: collapse; margin: 1rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding: .3rem 0; }
th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid #e6eaee; white-space: nowrap; }
th:first-child { text-align: left; } thead th { border-bottom: 2px solid #8a97a5; }
figure { margin: 1rem 0; } figcaption { color: #54626f; max-width: 60rem; }
svg { max-width: 100%; height: auto; } .scroll { overflow-x: auto; } .views { display: flex; flex-wrap: wrap; gap: 1rem; }
)";

std::string row(const std::vector<std::string>& cells, std::string_view first,
                std::string_view rest) {
  std::string text = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string tag(i == 0 ? first : rest);
    text += "<" + tag + ">" + escaped(cells[i]) + "</" + tag + ">";
  }
  return text + "</tr>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '<')
      result += "&lt;";
    else if (c == '>')
      result += "&gt;";
    else if (c == '&')
      result += "&amp;";
    else if (c == '"')
      result += "&quot;";
    else
      result += c;
  }
  return result;
}

std::string to_html(const Table& table) {
  std::string text = "<div class=\"scroll\"><table><caption>" + escaped(table.caption) +
                     "</caption>\n<thead>" + row(table.head, "th", "th") + "</thead>\n<tbody>\n";
  for (const auto& cells : table.rows)
    text += row(cells, "th", "td");
  return text + "</tbody></table></div>\n";
}

std::string heading(int level, std::string_view text) {
  const std::string tag = "h" + std::to_string(level);
  return "<" + tag + ">" + escaped(text) + "</" + tag + ">\n";
}

std::string paragraph(std::string_view text) { return "<p>" + escaped(text) + "</p>\n"; }

std::string page(std::string_view title, std::string_view body) {
  std::string text =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>";
  text += escaped(title);
  text += "</title><style>";
  text += kStyle;
  text += "</style></head>\n<body>\n";
  text += body;
  return text + "</body></html>\n";
}

}  // namespace kinship::experiments::html
