#include "client/plots/plot_pages.hpp"

#include <ostream>
#include <string_view>

#include "client/page/document.hpp"
#include "client/plots/plot_json.hpp"
#include "client/plots/plot_texts.hpp"
#include "proto/json/robot_answers_json.hpp"

namespace kinship::plots {
namespace {

/// A page of this room: NAME.html with NAME.js, and the shared files.
page::Document document_of(const std::string& name, std::string title, std::string data) {
  const auto text = [](const std::string& file) { return page::text_of(plot_texts(), file); };
  page::Document document;
  document.title = std::move(title);
  document.body = text(name + ".html");
  document.data = std::move(data);
  document.styles = {text("plots.css")};
  document.scripts = {text("plots.js"), text(name + ".js")};
  return document;
}

}  // namespace

void write_page(const DistributionPlot& plot, std::ostream& out) {
  page::Document document = document_of(
      "distribution", plot.label + " on " + plot.distribution.task + " - Kinship", to_json(plot));
  document.draws_scenes = document.draws_charts = true;
  page::write_document(document, out);
}

void write_page(const TaskHistory& history, std::ostream& out) {
  page::Document document = document_of("task", history.task + " - Kinship", to_json(history));
  document.draws_charts = true;
  page::write_document(document, out);
}

void write_page(const std::string& task, const std::vector<Transferability>& pairs,
                std::ostream& out) {
  page::write_document(
      document_of("worths", "Experience of " + task + " - Kinship", json::to_json(task, pairs)),
      out);
}

}  // namespace kinship::plots
