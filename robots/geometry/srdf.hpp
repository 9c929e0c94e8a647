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
  int line = 0;           ///< of its first mention
  std::size_t pairs = 0;  ///< left out because they name it
};

/// The pairs of links that an SRDF excludes from collision checking: its `disable_collisions`
/// elements, in their order, with any reason. The rest of the document is ignored; entities are not
/// expanded.
/// \param text   untrusted.
/// \param chain  of the document's robot, with the links of its URDF.
/// \param strangers  if not null: the links that pairs name and the robot does not have, each once.
/// \return       the pairs of the robot's links; TooLarge above kMaxSrdfBytes or
///               kMaxCollisionPairs; InvalidInput with the line for a document that is no XML or
///               has no <robot>, and for a pair without link1 or link2.
Result<std::vector<std::pair<std::string, std::string>>> read_srdf(
    std::string_view text, const kinematics::Chain& chain,
    std::vector<SrdfStranger>* strangers = nullptr);

/// Two links that an SRDF excludes, and the reason in MoveIt's words: Adjacent, Always, Default,
/// Never, User.
struct SrdfPair {
  std::string link_a, link_b, reason;
};

/// An SRDF with excluded pairs only.
/// \param comment  the origin of the document; without "--".
std::string write_srdf(const std::string& robot, const std::vector<SrdfPair>& pairs,
                       const std::string& comment);

}  // namespace kinship::geometry
