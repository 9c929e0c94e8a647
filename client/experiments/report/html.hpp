#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Pieces of an HTML document as text.
namespace kinship::experiments::html {

/// The text with what HTML would take for markup escaped.
std::string escaped(std::string_view text);

/// A table with a heading row and a heading column. Cells are text, escaped here.
struct Table {
  std::string caption;
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
};

std::string to_html(const Table& table);

std::string heading(int level, std::string_view text);
std::string paragraph(std::string_view text);

/// A page that needs nothing else: style inside, no scripts, nothing loaded.
std::string page(std::string_view title, std::string_view body);

}  // namespace kinship::experiments::html
