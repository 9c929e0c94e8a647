#pragma once

#include <cstdint>
#include <functional>

#include "server/store/report_digests.hpp"

namespace kinship::sites {

/// How the reports of a site and of the memory above it go together.
struct Comparison {
  std::uint64_t same = 0;             ///< with the same digest of their bodies
  std::uint64_t of_site_alone = 0;    ///< not carried yet, or refused
  std::uint64_t of_memory_alone = 0;  ///< of other sites
  std::uint64_t differing = 0;        ///< one UUID, two contents
  std::uint64_t damaged = 0;          ///< intact in the other store; damaged in both: not seen
};

enum class Difference { NotInMemory, TwoContents, DamagedInMemory, DamagedAtSite };

/// Compares every report by the digest of its body, some hundreds at a time; reads no content.
/// \param tell  called with each difference, but not with reports that the memory has alone.
/// \throws Failure of either store.
Comparison compare(store::ReportDigests& site, store::ReportDigests& memory,
                   const std::function<void(const Uuid& report, Difference)>& tell);

}  // namespace kinship::sites
