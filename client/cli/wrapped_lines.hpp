#pragma once

#include <cstddef>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace kinship::cli {

/// A line as lines of at most `width` characters, broken between words; what goes on is indented,
/// beneath the text behind "label   ". A longer word, and a line of JSON or XML, stays whole.
std::string wrapped(std::string_view line, std::size_t width);

/// Wraps the lines of a stream for its lifetime, so that nothing is wider than a terminal. What is
/// flushed before the end of its line is written as it is; a stream that flushes each word, as
/// std::cerr, flushes each line meanwhile.
class WrappedLines final : public std::streambuf {
 public:
  WrappedLines(std::ostream& out, std::size_t width);
  ~WrappedLines() override;  ///< writes what is left
  WrappedLines(const WrappedLines&) = delete;
  WrappedLines& operator=(const WrappedLines&) = delete;

 private:
  int_type overflow(int_type c) override;
  int sync() override;
  void put_line(bool ends);

  std::ostream& out_;
  std::streambuf* const behind_;
  const std::size_t width_;
  const bool is_unbuffered_;
  std::string line_;
  bool is_begun_ = false;  // a part of the line is written
};

}  // namespace kinship::cli
