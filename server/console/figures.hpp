#pragma once

#include <string>
#include <string_view>

#include "server/console/questions.hpp"

namespace kinship::console {

/// Makes the JSON document of a figure (pages/plots), which asks the service and computes: not on
/// the network's thread.
/// \throws Failure, e.g. NotFound for a name that is not known.
using FigureMaker = std::string (*)(Questions& questions, const std::string& name);

/// The maker of a kind of figure; null if there is none.
FigureMaker figure_maker(std::string_view kind);

}  // namespace kinship::console
