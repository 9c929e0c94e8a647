#include "tests/support/places.hpp"

namespace kinship::test {

std::string source_dir() { return KINSHIP_SOURCE_DIR; }

std::string bin_dir() { return KINSHIP_BIN_DIR; }

}  // namespace kinship::test
