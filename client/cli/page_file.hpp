#pragma once

#include <filesystem>
#include <iosfwd>

#include "proto/files/output_file.hpp"

namespace kinship::cli {

/// The output of a page: a file that gets its name once it is complete, or a stream for "-".
class PageFile {
 public:
  /// \throws Failure(Storage) as OutputFile.
  PageFile(const std::filesystem::path& file, std::ostream& otherwise);

  std::ostream& stream() noexcept { return output_.stream(); }

  /// Completes the page and writes its place to `err`. \throws Failure(Storage) as OutputFile.
  void keep(std::ostream& err);

 private:
  std::filesystem::path file_;  // empty: the stream
  files::OutputFile output_;
};

}  // namespace kinship::cli
