#include "server/store/sqlite/distribution_blob.hpp"

#include <stdexcept>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/sqlite/byte_stream.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kFormat = 1;  // written first; a new one when the fields change
constexpr std::size_t kMaxTextBytes = 1'000'000;

void add_source(ByteWriter& out, const Source& source) {
  out.add(std::span<const std::uint8_t>(source.robot.bytes)).add(source.label);
  out.add(source.paths).add(source.generation).add(source.poses).add(source.poses_solved);
}

Source read_source(ByteReader& in) {
  Source source;
  in.bytes(source.robot.bytes);
  source.label = in.text(kMaxTextBytes);
  source.paths = in.integer();
  source.generation = in.integer();
  source.poses = in.integer();
  source.poses_solved = in.integer();
  return source;
}

void add_mixture(ByteWriter& out, const Mixture& mixture) {
  out.add(mixture.weights()).add(mixture.means());
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    out.add(covariance);
}

Mixture read_mixture(ByteReader& in) {
  const Eigen::MatrixXd weights = in.matrix(kMaxComponents, 1);
  Eigen::MatrixXd means = in.matrix(kMaxDof, kMaxComponents);
  std::vector<Eigen::MatrixXd> covariances;
  for (Eigen::Index i = 0; i < weights.rows(); ++i)
    covariances.push_back(in.matrix(kMaxDof, kMaxDof));
  return {Eigen::VectorXd(weights.reshaped()), std::move(means), std::move(covariances)};
}

Distribution read_distribution(ByteReader& in) {
  if (in.integer() != kFormat)
    throw std::out_of_range("distribution: another format");
  Distribution distribution;
  in.bytes(distribution.id.bytes);
  distribution.task = in.text(kMaxTextBytes);
  in.bytes(distribution.robot.bytes);
  distribution.T_task_base = in.pose();
  distribution.profile = in.text(kMaxTextBytes);
  distribution.engines = in.text(kMaxTextBytes);
  distribution.state = in.integer() == 0 ? DistributionState::Ready : DistributionState::Failed;
  distribution.reason = in.text(kMaxTextBytes);
  distribution.configurations = in.integer();
  distribution.limits = in.matrix(2, kMaxDof);
  if (in.integer() != 0)
    distribution.held_out_score = in.real();
  distribution.advice.recommended_share = in.real();
  distribution.advice.evidence = in.text(kMaxTextBytes);
  distribution.fitted_ms = static_cast<std::int64_t>(in.integer());
  distribution.transfer_time_s = in.real();
  distribution.fit_time_s = in.real();
  const std::uint64_t sources = in.integer();
  if (sources > kMaxSources)
    throw std::out_of_range("distribution: too many sources");
  for (std::uint64_t i = 0; i < sources; ++i)
    distribution.sources.push_back(read_source(in));
  if (in.integer() != 0)
    distribution.mixture = read_mixture(in);
  if (!in.at_end())
    throw std::out_of_range("distribution: bytes left over");
  return distribution;
}

}  // namespace

std::vector<std::uint8_t> encode_distribution(const Distribution& distribution) {
  ByteWriter out;
  out.add(kFormat).add(std::span<const std::uint8_t>(distribution.id.bytes));
  out.add(distribution.task).add(std::span<const std::uint8_t>(distribution.robot.bytes));
  out.add(distribution.T_task_base).add(distribution.profile).add(distribution.engines);
  out.add(std::uint64_t{distribution.state == DistributionState::Ready ? 0U : 1U});
  out.add(distribution.reason).add(distribution.configurations);
  out.add(Eigen::MatrixXd(distribution.limits));
  out.add(std::uint64_t{distribution.held_out_score ? 1U : 0U});
  if (distribution.held_out_score)
    out.add(*distribution.held_out_score);
  out.add(distribution.advice.recommended_share).add(distribution.advice.evidence);
  out.add(static_cast<std::uint64_t>(distribution.fitted_ms));
  out.add(distribution.transfer_time_s).add(distribution.fit_time_s);
  out.add(std::uint64_t{distribution.sources.size()});
  for (const Source& source : distribution.sources)
    add_source(out, source);
  out.add(std::uint64_t{distribution.mixture ? 1U : 0U});
  if (distribution.mixture)
    add_mixture(out, *distribution.mixture);
  return out.bytes();
}

std::optional<Distribution> decode_distribution(std::span<const std::uint8_t> blob) {
  try {
    ByteReader in(blob);
    return read_distribution(in);
  } catch (const std::out_of_range&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {  // of Mixture
    return std::nullopt;
  }
}

}  // namespace kinship::store
