#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/result.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::geometry {

inline constexpr std::size_t kMaxSrdfBytes = 1'000'000;

/// A link that an SRDF names and its robot does not have.
struct SrdfStranger {
  std::string link;
  int line = 0;           ///< where it is named first
  std::size_t pairs = 0;  ///< left out because they name it
};

/// The pairs of links that an SRDF excepts from collision checking: its `disable_collisions`
/// elements, in their order, whatever their reason. The rest of the document is not looked at;
/// entities are not expanded.
/// \param text   untrusted.
/// \param chain  of the robot that the document is about; its links are those of the URDF.
/// \param strangers  if not null: the links that pairs name and the robot does not have, each once.
/// \return       the pairs of the robot's links; TooLarge above kMaxSrdfBytes or
///               kMaxCollisionPairs; InvalidInput with the line for what is no XML, no <robot>, or
///               a pair without link1 or link2.
Result<std::vector<std::pair<std::string, std::string>>> read_srdf(
    std::string_view text, const kinematics::Chain& chain,
    std::vector<SrdfStranger>* strangers = nullptr);

/// Two links that an SRDF excepts, and why in a word, as MoveIt has it: Adjacent, Always, Default,
/// Never, User.
struct SrdfPair {
  std::string link_a, link_b, reason;
};

/// An SRDF that says nothing but which pairs are excepted.
/// \param comment  what made it; free of "--".
std::string write_srdf(const std::string& robot, const std::vector<SrdfPair>& pairs,
                       const std::string& comment);

}  // namespace kinship::geometry
