#include "client/experiments/pipeline/compressed_file.hpp"

#include <zstd.h>

#include <fstream>
#include <iostream>
#include <iterator>

#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr int kLevel = 19;  // files are written once and committed

std::string read_all(const std::filesystem::path& file) {
  std::ifstream stream = files::open_input(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_all(const std::filesystem::path& file, const std::string& content) {
  files::OutputFile output(file, std::cout);
  output.stream().write(content.data(), static_cast<std::streamsize>(content.size()));
  output.keep();
}

}  // namespace

std::filesystem::path compressed_name(const std::filesystem::path& file) {
  return file.string() + ".zst";
}

void compress_file(const std::filesystem::path& file) {
  const std::string content = read_all(file);
  std::string compressed(ZSTD_compressBound(content.size()), '\0');
  const std::size_t size =
      ZSTD_compress(compressed.data(), compressed.size(), content.data(), content.size(), kLevel);
  if (ZSTD_isError(size) != 0)
    throw Failure(ErrorCode::Internal,
                  "'" + file.string() + "' cannot be compressed: " + ZSTD_getErrorName(size));
  compressed.resize(size);
  write_all(compressed_name(file), compressed);
}

bool expand_file(const std::filesystem::path& file) {
  const std::filesystem::path twin = compressed_name(file);
  if (std::filesystem::exists(file))
    return true;
  if (!std::filesystem::exists(twin))
    return false;
  const std::string compressed = read_all(twin);
  const unsigned long long size = ZSTD_getFrameContentSize(compressed.data(), compressed.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN)
    throw Failure(ErrorCode::InvalidInput, "'" + twin.string() + "' is no zstd file of known size");
  if (size > kMaxExpandedBytes)
    throw Failure(ErrorCode::TooLarge, "'" + twin.string() + "' holds " + std::to_string(size) +
                                           " bytes, at most " + std::to_string(kMaxExpandedBytes));
  std::string content(size, '\0');
  const std::size_t expanded =
      ZSTD_decompress(content.data(), content.size(), compressed.data(), compressed.size());
  if (ZSTD_isError(expanded) != 0 || expanded != content.size())
    throw Failure(ErrorCode::InvalidInput, "'" + twin.string() + "' is damaged");
  write_all(file, content);
  return true;
}

}  // namespace kinship::experiments
