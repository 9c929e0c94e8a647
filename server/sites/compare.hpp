#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "server/store/replication_store.hpp"

namespace kinship::sites {

/// How the reports of a site and of the memory above it go together.
struct Comparison {
  std::uint64_t same = 0;             ///< with the same digest of their bodies
  std::uint64_t of_site_alone = 0;    ///< not carried yet, or refused
  std::uint64_t of_memory_alone = 0;  ///< of other sites
  std::uint64_t differing = 0;        ///< one UUID, two contents
};

/// Compares every report by the digest of its body, some hundreds at a time; reads no content.
/// \param tell  called with each report that the site has alone, or that differs.
/// \throws Failure of either store.
Comparison compare(const store::ReplicationStore& site, const store::ReplicationStore& memory,
                   const std::function<void(const Uuid& report, bool is_differing)>& tell);

}  // namespace kinship::sites
