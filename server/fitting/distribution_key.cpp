#include "server/fitting/distribution_key.hpp"

#include <algorithm>
#include <string_view>

#include "proto/types/field_digest.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/profile_text.hpp"
#include "proto/types/sha256.hpp"
#include "robots/inverse/inverse.hpp"
#include "server/density/fit.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::fitting {
namespace {

std::uint64_t bits(int value) { return static_cast<std::uint64_t>(std::int64_t{value}); }

/// What is wrong with a selection, or nothing.
std::optional<Error> check_selection(const Selection& selection) {
  if (selection.sources.size() > kMaxSelectedSources)
    return Error{ErrorCode::InvalidInput, std::to_string(selection.sources.size()) +
                                              " selected sources exceed " +
                                              std::to_string(kMaxSelectedSources)};
  if (selection.since_ms < 0)
    return Error{ErrorCode::InvalidInput,
                 "since: " + std::to_string(selection.since_ms) + " ms is below 0"};
  return std::nullopt;
}

}  // namespace

Result<DistributionKey> make_key(const FetchRequest& request) {
  if (const auto error = check_task(request.task))
    return *error;
  const Result<Profile> profile = profile_from_text(request.profile);
  if (!profile)
    return profile.error();
  if (const auto error = check_selection(request.selection))
    return *error;
  DistributionKey key{request.task,
                      request.robot,
                      std::nullopt,
                      *profile,
                      request.selection.sources,
                      request.selection.since_ms};
  if (request.selection.weighting)
    key.profile.density.weighting = *request.selection.weighting;
  std::sort(key.sources.begin(), key.sources.end());
  key.sources.erase(std::unique(key.sources.begin(), key.sources.end()), key.sources.end());
  if (!request.T_task_base)
    return key;
  const Eigen::Isometry3d& T_task_base = *request.T_task_base;
  if (!T_task_base.matrix().allFinite() ||
      T_task_base.translation().cwiseAbs().maxCoeff() > kMaxPlacement_m)
    return Error{ErrorCode::InvalidInput, "placement: a coordinate is not finite or exceeds " +
                                              std::to_string(kMaxPlacement_m) + " m"};
  key.T_task_base = snapped(T_task_base);
  return key;
}

Digest identify(const DistributionKey& key) {
  Sha256 sha;
  sha.add(std::string_view("distribution")).add(std::string_view(key.task)).add(key.robot);
  sha.add(std::uint64_t{key.T_task_base ? 1U : 0U});
  if (key.T_task_base) {
    const Eigen::MatrixXd placement = key.T_task_base->matrix().topRows<3>();  // 3 x 4
    sha.add(placement);
  }
  add_fields(key.profile.transfer, sha);
  add_fields(key.profile.density, sha);
  sha.add(key.profile.recommended_share).add(key.profile.thin_share).add(key.profile.seed);
  sha.add(std::uint64_t{key.sources.size()});
  for (const Digest& source : key.sources)
    sha.add(source);
  sha.add(static_cast<std::uint64_t>(key.since_ms)).add(bits(kPoolVersion));
  sha.add(bits(transfer::kTransferVersion)).add(bits(inverse::kInverseVersion));
  sha.add(bits(density::kDensityVersion));
  return sha.finish();
}

std::string engines() {
  return "pool " + std::to_string(kPoolVersion) + ", transfer " +
         std::to_string(transfer::kTransferVersion) + ", inverse " +
         std::to_string(inverse::kInverseVersion) + ", density " +
         std::to_string(density::kDensityVersion);
}

}  // namespace kinship::fitting
