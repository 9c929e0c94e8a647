#include "server/store/sqlite/distribution_blob.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"
#include "server/store/sqlite/byte_stream.hpp"

namespace kinship::store {
namespace {

// Written first. 1 knew neither the selection nor the details of a source, 2 neither how its tracks
// and filters fared nor thin distributions, 3 neither how the number of components was chosen nor
// cuts, 4 not what a fit began with, 5 no covariance that all components share, 6 not how many
// tracks came through; all are still read.
constexpr std::uint64_t kFormat = 7;
constexpr std::size_t kMaxTextBytes = 1'000'000;

template <typename Enum>
Enum enumerator(ByteReader& in, Enum last) {
  const std::uint64_t value = in.integer();
  if (value > static_cast<std::uint64_t>(last))
    throw std::out_of_range("distribution: enumerator " + std::to_string(value));
  return static_cast<Enum>(value);
}

void add_source(ByteWriter& out, const Source& source) {
  out.add(std::span<const std::uint8_t>(source.robot.bytes)).add(source.label);
  out.add(source.paths).add(source.generation).add(source.poses).add(source.poses_solved);
  out.add(static_cast<std::uint64_t>(source.relation)).add(source.paths_used);
  out.add(source.out_of_reach).add(source.outside_limits).add(source.not_converged);
  out.add(source.configurations).add(source.mass);
  out.add(source.colliding).add(source.tracks_tried).add(source.tracks_kept);
  out.add(source.random_configurations).add(source.filter_checks).add(source.self_collisions);
  out.add(source.scene_collisions).add(source.paths_with_scene).add(source.tracks_through);
}

void read_details(ByteReader& in, Source& source) {
  source.relation = enumerator<Relation>(in, Relation::Identical);
  source.paths_used = in.integer();
  source.out_of_reach = in.integer();
  source.outside_limits = in.integer();
  source.not_converged = in.integer();
  source.configurations = in.integer();
  source.mass = in.real();
}

void read_tracks_and_filters(ByteReader& in, Source& source) {
  source.colliding = in.integer();
  source.tracks_tried = in.integer();
  source.tracks_kept = in.integer();
  source.random_configurations = in.integer();
  source.filter_checks = in.integer();
  source.self_collisions = in.integer();
  source.scene_collisions = in.integer();
  source.paths_with_scene = in.integer();
}

Source read_source(ByteReader& in, std::uint64_t format) {
  Source source;
  in.bytes(source.robot.bytes);
  source.label = in.text(kMaxTextBytes);
  source.paths = in.integer();
  source.generation = in.integer();
  source.poses = in.integer();
  source.poses_solved = in.integer();
  if (format > 1)
    read_details(in, source);
  else
    source.paths_used = source.paths;  // fits left none out then
  if (format > 2)
    read_tracks_and_filters(in, source);
  if (format > 6)
    source.tracks_through = in.integer();
  return source;
}

void add_selection(ByteWriter& out, const Selection& selection) {
  out.add(std::uint64_t{selection.sources.size()});
  for (const Digest& robot : selection.sources)
    out.add(std::span<const std::uint8_t>(robot.bytes));
  out.add(std::uint64_t{selection.weighting ? 1U : 0U});
  if (selection.weighting)
    out.add(static_cast<std::uint64_t>(*selection.weighting));
  out.add(static_cast<std::uint64_t>(selection.since_ms));
}

Selection read_selection(ByteReader& in) {
  Selection selection;
  const std::uint64_t sources = in.integer();
  if (sources > kMaxSelectedSources)
    throw std::out_of_range("distribution: too many selected sources");
  for (std::uint64_t i = 0; i < sources; ++i)
    in.bytes(selection.sources.emplace_back().bytes);
  if (in.integer() != 0)
    selection.weighting = enumerator<Weighting>(in, Weighting::Paths);
  selection.since_ms = static_cast<std::int64_t>(in.integer());
  return selection;
}

/// Scores of numbers of components and cuts of continuous joints.
void add_choice(ByteWriter& out, const Distribution& distribution) {
  out.add(std::uint64_t{distribution.component_scores.size()});
  for (const ComponentScore& score : distribution.component_scores)
    out.add(static_cast<std::uint64_t>(score.components)).add(score.score);
  out.add(std::uint64_t{distribution.cuts.size()});
  for (const std::optional<double>& cut : distribution.cuts) {
    out.add(std::uint64_t{cut ? 1U : 0U});
    if (cut)
      out.add(*cut);
  }
}

double finite(double value) {
  if (!std::isfinite(value))
    throw std::out_of_range("distribution: a number is not finite");
  return value;
}

void read_choice(ByteReader& in, Distribution& distribution) {
  const std::uint64_t scores = in.integer();
  if (scores > kMaxComponentScores)
    throw std::out_of_range("distribution: too many scores of components");
  for (std::uint64_t i = 0; i < scores; ++i) {
    const std::uint64_t components = in.integer();
    if (components < 1 || components > kMaxComponents)
      throw std::out_of_range("distribution: a score of no or too many components");
    distribution.component_scores.push_back(
        {.components = static_cast<int>(components), .score = finite(in.real())});
  }
  const std::uint64_t cuts = in.integer();
  if (cuts != 0 && cuts != static_cast<std::uint64_t>(distribution.limits.cols()))
    throw std::out_of_range("distribution: cuts of other joints than it has");
  for (std::uint64_t i = 0; i < cuts; ++i)
    distribution.cuts.push_back(in.integer() != 0 ? std::optional(finite(in.real()))
                                                  : std::nullopt);
}

void add_fit(ByteWriter& out, const std::optional<FitOrigin>& fit) {
  out.add(std::uint64_t{fit ? 1U : 0U});
  if (fit)
    out.add(fit->from_revision)
        .add(fit->full_revision)
        .add(fit->paths)
        .add(fit->new_paths)
        .add(fit->transferred)
        .add(fit->reason);
}

std::optional<FitOrigin> read_fit(ByteReader& in) {
  if (in.integer() == 0)
    return std::nullopt;
  FitOrigin fit;
  fit.from_revision = in.integer();
  fit.full_revision = in.integer();
  fit.paths = in.integer();
  fit.new_paths = in.integer();
  fit.transferred = in.integer();
  fit.reason = in.text(kMaxTextBytes);
  return fit;
}

void add_mixture(ByteWriter& out, const Mixture& mixture) {
  out.add(mixture.weights()).add(mixture.means());
  out.add(std::uint64_t{mixture.covariances().size()});
  for (const Eigen::MatrixXd& covariance : mixture.covariances())
    out.add(covariance);
}

Mixture read_mixture(ByteReader& in, std::uint64_t format) {
  const Eigen::MatrixXd weights = in.matrix(kMaxKernels, 1);
  Eigen::MatrixXd means = in.matrix(kMaxDof, kMaxKernels);
  const std::uint64_t count = format > 5 ? in.integer() : std::uint64_t(weights.rows());
  if (count > kMaxComponents || (count > 1 && std::uint64_t(weights.rows()) != count))
    throw std::out_of_range("distribution: too many covariances, or other than components");
  std::vector<Eigen::MatrixXd> covariances;
  for (std::uint64_t i = 0; i < count; ++i)
    covariances.push_back(in.matrix(kMaxDof, kMaxDof));
  return {Eigen::VectorXd(weights.reshaped()), std::move(means), std::move(covariances)};
}

Distribution read_distribution(ByteReader& in) {
  const std::uint64_t format = in.integer();
  if (format < 1 || format > kFormat)
    throw std::out_of_range("distribution: another format");
  Distribution distribution;
  in.bytes(distribution.id.bytes);
  distribution.task = in.text(kMaxTextBytes);
  in.bytes(distribution.robot.bytes);
  distribution.T_task_base = in.pose();
  distribution.profile = in.text(kMaxTextBytes);
  distribution.engines = in.text(kMaxTextBytes);
  distribution.state = enumerator<DistributionState>(in, DistributionState::Thin);
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
    distribution.sources.push_back(read_source(in, format));
  if (in.integer() != 0)
    distribution.mixture = read_mixture(in, format);
  if (format > 1)
    distribution.selection = read_selection(in);
  if (format > 3)
    read_choice(in, distribution);
  if (format > 4)
    distribution.fit = read_fit(in);
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
  out.add(static_cast<std::uint64_t>(distribution.state));
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
  add_selection(out, distribution.selection);
  add_choice(out, distribution);
  add_fit(out, distribution.fit);
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
