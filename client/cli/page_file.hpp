#pragma once

#include <filesystem>
#include <iosfwd>

#include "proto/files/output_file.hpp"

namespace kinship::cli {

/// Where a page goes: a file that has its name once it is whole, or a stream for "-".
class PageFile {
 public:
  /// \throws Failure(Storage) as OutputFile.
  PageFile(const std::filesystem::path& file, std::ostream& otherwise);

  std::ostream& stream() noexcept { return output_.stream(); }

  /// The page is whole; says on `err` where it is. \throws Failure(Storage) as OutputFile.
  void keep(std::ostream& err);

 private:
  std::filesystem::path file_;  // empty: the stream
  files::OutputFile output_;
};

}  // namespace kinship::cli
