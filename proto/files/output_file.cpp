#include "proto/files/output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <ostream>
#include <system_error>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::files {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& reason) {
  throw Failure(ErrorCode::Storage, "cannot write '" + file.string() + "': " + reason);
}

std::string system_message(int error) { return std::system_category().message(error); }

fs::path part_of(const fs::path& file) { return fs::path(file) += ".part"; }

void open(std::ofstream& stream, const fs::path& file) {
  errno = 0;
  stream.open(file, std::ios::binary | std::ios::trunc);
  if (!stream)
    refuse(file, system_message(errno));
}

}  // namespace

OutputFile::OutputFile(fs::path file, std::ostream& otherwise)
    : file_(std::move(file)), stream_(&otherwise) {
  if (file_.empty())
    return;
  std::error_code unknown;
  const fs::file_status there = fs::symlink_status(file_, unknown);
  if (fs::exists(there) && !fs::is_regular_file(there)) {
    open(output_, file_);
  } else {
    if (fs::exists(there) && access(file_.c_str(), W_OK) != 0)
      refuse(file_, system_message(errno));
    open(output_, part_of(file_));
    part_ = part_of(file_);
    if (fs::exists(there))
      fs::permissions(part_, there.permissions(), unknown);
  }
  stream_ = &output_;
}

OutputFile::~OutputFile() {
  if (part_.empty() || is_kept_)
    return;
  output_.close();
  std::error_code ignored;
  if (fs::file_size(part_, ignored) == 0)
    fs::remove(part_, ignored);
}

bool OutputFile::has_part() {
  if (part_.empty() || is_kept_)
    return false;
  output_.flush();
  std::error_code unknown;
  const std::uintmax_t bytes = fs::file_size(part_, unknown);
  return !unknown && bytes > 0;
}

void OutputFile::keep() {
  errno = 0;
  stream_->flush();
  if (output_.is_open())
    output_.close();  // a failure sets its failbit
  if (!*stream_)
    refuse(file_.empty() ? "standard output" : file_, system_message(errno));
  if (!part_.empty()) {
    std::error_code error;
    fs::rename(part_, file_, error);
    if (error)
      refuse(file_, error.message());
  }
  is_kept_ = true;
}

bool overwrites(const fs::path& output, const fs::path& input) {
  std::error_code ignored;  // one of them is not there
  if (output.empty())
    return false;
  return fs::equivalent(output, input, ignored) || fs::equivalent(part_of(output), input, ignored);
}

}  // namespace kinship::files
