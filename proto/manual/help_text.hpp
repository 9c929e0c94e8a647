#pragma once

#include <memory>

namespace CLI {  // NOLINT: theirs
class FormatterBase;
}

namespace kinship::manual {

/// Help in 80 columns: options as typed, their values and their descriptions.
std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace kinship::manual
