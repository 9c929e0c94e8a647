#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "pages/page/embedded_text.hpp"

namespace kinship::page {

/// One self-contained HTML page.
struct Document {
  std::string title;                      ///< of the browser's tab; plain text
  std::string body;                       ///< HTML, the content of <main>
  std::string data;                       ///< one JSON document: kinshipPage.data
  std::vector<std::string_view> styles;   ///< CSS after page.css
  std::vector<std::string_view> scripts;  ///< run in order once the body is there
  bool draws_scenes = false;              ///< three.js, kinshipView and kinshipPlayer
  bool draws_charts = false;              ///< Vega and kinshipCharts
};

/// Writes the page: style, programs and data are in it, and it forbids the browser to load
/// anything (Content-Security-Policy).
/// \throws std::invalid_argument if a style or script would end its own element.
void write_document(const Document& document, std::ostream& out);

/// The programs of this folder and Debian's in the order in which they run. None needs `eval`,
/// inline handlers or inline styles, so that a server may send them as files under a strict
/// Content-Security-Policy.
std::vector<EmbeddedText> programs(bool draws_scenes, bool draws_charts);

/// Plain text as HTML.
std::string escaped(std::string_view text);

}  // namespace kinship::page
