#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include "proto/types/exit_code.hpp"
#include "proto/types/result.hpp"

namespace kinship::cli {

/// Writes an error after `command`. \return its exit code.
int refuse(std::string_view command, const Error& error, std::ostream& err);

/// Whether a stream is standard output or standard error and a terminal.
bool is_terminal(const std::ostream& stream);

/// Whether colours may be written to a stream: a terminal, and the environment has no NO_COLOR
/// (https://no-color.org).
bool may_colour(const std::ostream& stream);

/// A status line: on a terminal it is overwritten, elsewhere each text is a new line.
class StatusLine {
 public:
  /// \param stream    outlives the line.
  /// \param is_shown  false: nothing is written.
  StatusLine(std::ostream& stream, bool is_shown)
      : stream_(stream), is_shown_(is_shown), is_rewritten_(is_terminal(stream)) {}
  ~StatusLine() { clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  void show(std::string_view text);
  void clear();  ///< before any other output to the terminal

 private:
  std::ostream& stream_;
  const bool is_shown_, is_rewritten_;
  bool is_there_ = false;
};

}  // namespace kinship::cli
