#pragma once

#include <cstdlib>
#include <string_view>

namespace kinship::test {

/// Whether KINSHIP_LONG=1 asks for the variant of a test that takes minutes.
inline bool is_long_run() {
  const char* const wish = std::getenv("KINSHIP_LONG");  // NOLINT(concurrency-mt-unsafe)
  return wish && std::string_view(wish) == "1";
}

}  // namespace kinship::test
