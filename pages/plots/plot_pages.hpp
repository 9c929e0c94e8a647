#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "pages/page/embedded_text.hpp"
#include "pages/plots/attempt_figure.hpp"
#include "pages/plots/distribution_figure.hpp"
#include "pages/plots/robot_figure.hpp"
#include "pages/plots/task_history.hpp"
#include "pages/plots/task_paths.hpp"
#include "proto/types/transferability.hpp"

/// Pages of a server's data: one HTML document each, which needs no network (pages/page), with its
/// data as one JSON document in it. Lengths are whole millimetres, times Unix time in ms.
namespace kinship::plots {

/// The distribution as in `distributions fetch --json`, without its mixture, and the data derived
/// from it.
std::string to_json(const DistributionFigure& figure);

/// A task over time and in space.
struct TaskFigure {
  TaskHistory history;
  TaskPaths paths;
};

/// That of the history, with the paths as member `space`.
std::string to_json(const TaskFigure& figure);

void write_page(const DistributionFigure& figure, std::ostream& out);
void write_page(const TaskFigure& figure, std::ostream& out);
void write_page(const RobotFigure& figure, std::ostream& out);

/// \param command  that writes it: `paths plot` or `attempts plot`.
void write_page(const AttemptFigure& figure, const std::string& command, std::ostream& out);

/// A matrix, a target per row. \param pairs  every target with the same sources in the same order.
void write_page(const std::string& task, const std::vector<Transferability>& pairs,
                std::ostream& out);

/// The programs of all figures, in the order in which they run, for a server that sends them as
/// files: each figure is kinshipFigures.NAME(element, data, {href}). Styles: page.css, plots.css.
std::vector<page::EmbeddedText> figure_programs();

}  // namespace kinship::plots
