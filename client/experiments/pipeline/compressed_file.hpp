#pragma once

#include <filesystem>
#include <string>

namespace kinship::experiments {

/// `<file>.zst`: what is committed of a file of results or experience.
std::filesystem::path compressed_name(const std::filesystem::path& file);

/// Writes the compressed twin of a file. Equal content, equal bytes.
/// \throws Failure(NotFound or Storage) that names the file.
void compress_file(const std::filesystem::path& file);

/// Writes the file anew if only its compressed twin is there.
/// \return whether the file is there now.
/// \throws Failure(InvalidInput) that names the twin if it is damaged, TooLarge if it holds more
///         than kMaxExpandedBytes.
bool expand_file(const std::filesystem::path& file);

inline constexpr std::size_t kMaxExpandedBytes = 1'000'000'000;

}  // namespace kinship::experiments
