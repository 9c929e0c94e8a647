#include "server/fitting/distribution_key.hpp"

#include <algorithm>
#include <string_view>

#include "proto/types/field_digest.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/profile_text.hpp"
#include "proto/types/sha256.hpp"
#include "robots/inverse/inverse.hpp"
#include "server/density/fit.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::fitting {
namespace {

std::uint64_t bits(int value) { return static_cast<std::uint64_t>(std::int64_t{value}); }

}  // namespace

Result<DistributionKey> make_key(const FetchRequest& request, std::uint64_t geometry_revision) {
  const Result<Profile> profile = profile_from_text(request.profile);
  if (!profile)
    return profile.error();
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
  if (request.T_task_base)
    key.T_task_base = snapped(*request.T_task_base);
  const TransferParameters& transfer = key.profile.transfer;
  if (transfer.avoid_self_collision || transfer.avoid_recorded_scene)
    key.geometry_revision = geometry_revision;
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
  if (key.geometry_revision > 0)  // ids of robots that keep their geometry stay the same
    sha.add(std::string_view("geometry")).add(key.geometry_revision);
  return sha.finish();
}

std::string engines() {
  return "pool " + std::to_string(kPoolVersion) + ", transfer " +
         std::to_string(transfer::kTransferVersion) + ", inverse " +
         std::to_string(inverse::kInverseVersion) + ", density " +
         std::to_string(density::kDensityVersion);
}

}  // namespace kinship::fitting
