#pragma once

#include <memory>

namespace CLI {  // NOLINT: theirs
class FormatterBase;
}

namespace kinship::manual {

/// Help in 80 columns: options as one types them, what they take, and what they are about.
std::shared_ptr<CLI::FormatterBase> help_formatter();

}  // namespace kinship::manual
