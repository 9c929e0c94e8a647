#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::kinematics {

inline constexpr int kMaxUrdfDepth = 64;       ///< of nested elements: the parser recurses
inline constexpr int kMaxUrdfAttributes = 64;  ///< of one element: the parser searches linearly
inline constexpr int kMaxUrdfLinks = 1024;

/// Why a text is unfit for the XML parser, or nothing. Checks size, control characters, nesting,
/// attributes and number of links in one pass, and refuses document types, which could declare
/// entities. Does not check that the text is a URDF.
std::optional<Error> check_markup(std::string_view text);

/// The text with a blank for each tab and line break within an attribute's value, and with none
/// around numbers: urdfdom separates numbers at blanks only and accepts none after a single number,
/// while XML treats all three as one. A reference (`&#10;`) stays.
/// \param text  one that check_markup accepts.
/// Source: W3C, Extensible Markup Language (XML) 1.0, 3.3.3 Attribute-Value Normalization.
std::string normalize_attributes(std::string_view text);

}  // namespace kinship::kinematics
