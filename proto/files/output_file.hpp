#pragma once

#include <filesystem>
#include <fstream>
#include <iosfwd>

namespace kinship::files {

/// Output of a program: a file that has its name only once it is complete, or a stream if no file
/// is named.
///
/// The file is written as `<file>.part` and renamed by keep(). Without keep() the old file stays as
/// it was, and the content stays as `<file>.part`, unless it is empty. An existing non-regular file
/// (/dev/null, a FIFO, a symbolic link) is never replaced: it is written directly. Not for several
/// threads; two programs must not write one file.
class OutputFile {
 public:
  /// \param file       empty: write to `otherwise`.
  /// \param otherwise  outlives the object.
  /// \throws Failure(Storage) that names the file if it cannot be written; then nothing is changed.
  OutputFile(std::filesystem::path file, std::ostream& otherwise);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() noexcept { return *stream_; }

  /// Completes the file and gives it its name. The stream must not be used afterwards.
  /// \throws Failure(Storage) if writing failed; then the old file stays.
  void keep();

  /// Whether there is content that is not kept: it stays as part().
  bool has_part();

  /// File of the content until it is kept; empty for a stream or a file that is written directly.
  const std::filesystem::path& part() const noexcept { return part_; }

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;
  std::ofstream output_;
  std::ostream* stream_;
  bool is_kept_ = false;
};

/// Whether writing the output, as OutputFile does, would destroy the input.
bool overwrites(const std::filesystem::path& output, const std::filesystem::path& input);

}  // namespace kinship::files
