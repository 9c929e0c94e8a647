#pragma once

#include <string>

namespace kinship::test {

/// The folder of the sources, and of the programs that are tested; absolute, without a slash at the
/// end.
std::string source_dir();
std::string bin_dir();

}  // namespace kinship::test
