#include "tests/golden/pins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "proto/types/hex.hpp"
#include "tests/support/places.hpp"

namespace kinship::test {
namespace {

std::filesystem::path path_of(const std::string& name) {
  return std::filesystem::path(test::source_dir() + "/tests/golden/pins") / name;
}

/// The line at which two texts part, of each.
std::string first_difference(std::string_view pinned, std::string_view text) {
  const auto [at, other] = std::mismatch(pinned.begin(), pinned.end(), text.begin(), text.end());
  constexpr std::size_t kBefore = 60, kShown = 200;
  const auto place = static_cast<std::size_t>(at - pinned.begin());
  const std::size_t from = place - std::min(place, kBefore);
  return "at byte " + std::to_string(place) + ": pinned '" +
         std::string(pinned.substr(from, kShown)) + "', now '" +
         std::string(text.substr(from, kShown)) + "'";
}

}  // namespace

std::string read_pin(const std::string& name) {
  std::ifstream file(path_of(name), std::ios::binary);
  EXPECT_TRUE(file) << name << ": no such pin";
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_pinned(const std::string& name, std::string_view text) {
  if (std::getenv("KINSHIP_WRITE_GOLDEN") != nullptr) {
    std::filesystem::create_directories(path_of(name).parent_path());
    std::ofstream(path_of(name), std::ios::binary) << text;
    return;
  }
  const std::string pinned = read_pin(name);
  EXPECT_TRUE(pinned == text) << name << ": " << first_difference(pinned, text);
}

void expect_pinned_bytes(const std::string& name, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kPerLine = 32;
  std::string text;
  for (; !bytes.empty(); bytes = bytes.subspan(std::min(kPerLine, bytes.size())))
    text += to_hex(bytes.first(std::min(kPerLine, bytes.size()))) + "\n";
  expect_pinned(name, text);
}

std::vector<std::uint8_t> read_pinned_bytes(const std::string& name) {
  std::string digits = read_pin(name);
  std::erase(digits, '\n');
  std::vector<std::uint8_t> bytes(digits.size() / 2);
  EXPECT_TRUE(parse_hex(digits, bytes)) << name;
  return bytes;
}

}  // namespace kinship::test
