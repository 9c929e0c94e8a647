#include "robots/models/text_file.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "proto/types/failure.hpp"

namespace kinship::models {

std::string read_text(const std::filesystem::path& file, std::size_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw Failure(ErrorCode::NotFound, file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::string text(std::min<std::uintmax_t>(error ? max_bytes : size, max_bytes) + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad() || (stream.fail() && !stream.eof()))
    throw Failure(ErrorCode::InvalidInput, file.string() + ": cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > max_bytes)
    throw Failure(ErrorCode::TooLarge,
                  file.string() + ": exceeds " + std::to_string(max_bytes) + " bytes");
  return text;
}

}  // namespace kinship::models
