#pragma once

#include <filesystem>
#include <fstream>
#include <iosfwd>

namespace kinship::files {

/// Where a program writes what it was asked for: a file that has its name only once it is whole,
/// or a stream if no file was named.
///
/// The file is written as `<file>.part` and renamed by keep(). Without keep() the old file stays as
/// it was, and what was written stays as `<file>.part`, unless it is empty. What is there already
/// and is no regular file (/dev/null, a FIFO, a symbolic link) is never replaced: it is written
/// through, at once. Not for several threads; two programs must not write one file.
class OutputFile {
 public:
  /// \param file       empty: `otherwise` is written to.
  /// \param otherwise  must outlive this.
  /// \throws Failure(Storage) that names the file if it cannot be written; nothing is changed then.
  OutputFile(std::filesystem::path file, std::ostream& otherwise);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() noexcept { return *stream_; }

  /// Everything is written: the file gets its name. The stream is not to be used afterwards.
  /// \throws Failure(Storage) if something could not be written; the old file stays then.
  void keep();

  /// Whether something is written that is not kept: it stays as part().
  bool has_part();

  /// Where the content is as long as it is not kept; empty for a stream or what is written through.
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
