#include "client/cli/terminal.hpp"

#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "proto/tables/table_layout.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kBeginAgain = "\r\033[K";

}  // namespace

int refuse(std::string_view command, const Error& error, std::ostream& err) {
  err << command << ": " << error.message << '\n';
  return exit_code(error.code);
}

bool is_terminal(const std::ostream& stream) {
  return (&stream == &std::cout && isatty(STDOUT_FILENO) == 1) ||
         (&stream == &std::cerr && isatty(STDERR_FILENO) == 1);
}

bool may_colour(const std::ostream& stream) {
  const char* const no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe)
  return is_terminal(stream) && (no_colour == nullptr || *no_colour == '\0');
}

void StatusLine::show(std::string_view text) {
  if (!is_shown_)
    return;
  if (!is_rewritten_) {
    stream_ << text << std::endl;
    return;
  }
  stream_ << kBeginAgain << text.substr(0, tables::width_of_terminal() - 1) << std::flush;
  is_there_ = true;
}

void StatusLine::clear() {
  if (is_there_)
    stream_ << kBeginAgain << std::flush;
  is_there_ = false;
}

}  // namespace kinship::cli
