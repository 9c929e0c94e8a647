#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <string>

#include "proto/types/result.hpp"

namespace kinship::files {

inline constexpr std::size_t kMaxLineBytes = 64'000'000;

/// A line of a text file that is not blank.
struct Line {
  std::size_t number = 0;    ///< counts from 1, including blank ones
  Result<std::string> text;  ///< without the line feed; TooLarge for a line above the limit
};

/// Hands over the lines of a stream one after another; at most one of them is in memory.
/// \param name  of the file, for messages.
/// \param use   returns false to end the reading.
/// \throws Failure(Storage) that names the file and the line if the stream cannot be read.
void for_each_line(std::istream& stream, const std::string& name,
                   const std::function<bool(const Line&)>& use,
                   std::size_t max_bytes = kMaxLineBytes);

/// \throws Failure(NotFound) that names the file if it cannot be opened, Failure(InvalidInput) if
/// it
///         is a folder.
std::ifstream open_input(const std::filesystem::path& file);

}  // namespace kinship::files
