#include "proto/codec/mixture_codec.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "proto/codec/writer.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

/// Numbers in the lower triangle of a d x d matrix.
std::size_t triangle_size(std::size_t dimension) { return dimension * (dimension + 1) / 2; }

template <typename Sequence>
void write_triangles(const std::vector<Eigen::MatrixXd>& matrices, std::size_t dimension,
                     Arena& arena, Sequence& wire) {
  arena.resize(wire, matrices.size() * triangle_size(dimension));
  double* next = wire._buffer;
  for (const Eigen::MatrixXd& matrix : matrices)
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
      for (Eigen::Index column = 0; column <= row; ++column)
        *next++ = matrix(row, column);
}

std::vector<Eigen::MatrixXd> read_triangles(std::span<const double> numbers,
                                            std::size_t dimension) {
  const auto d = static_cast<Eigen::Index>(dimension);
  std::vector<Eigen::MatrixXd> matrices(numbers.size() / triangle_size(dimension),
                                        Eigen::MatrixXd(d, d));
  const double* next = numbers.data();
  for (Eigen::MatrixXd& matrix : matrices)
    for (Eigen::Index row = 0; row < d; ++row)
      for (Eigen::Index column = 0; column <= row; ++column)
        matrix(row, column) = matrix(column, row) = *next++;
  return matrices;
}

/// The numbers of a message that become a mixture.
template <typename Number>
struct Parts {
  const char* name;  // of the structure
  const char* name_of_means;
  std::span<const double> weights;
  std::span<const Number> means;
  std::span<const double> covariances;
  std::size_t most;  // components
  bool is_shared;    // one covariance for all
  std::size_t dimension;
};

template <typename Number>
std::optional<Mixture> read_parts(const Parts<Number>& parts, Reader& reader) {
  const std::string name = parts.name;
  reader.rules
      .that(parts.dimension > 0 && !parts.weights.empty(), name + ": no joint or no component")
      .at_most(name + ": components", parts.weights.size(), parts.most);
  if (reader.rules.broken())
    return std::nullopt;  // the products below cannot overflow
  const std::size_t means = parts.weights.size() * parts.dimension;
  const std::size_t covariances =
      (parts.is_shared ? 1 : parts.weights.size()) * triangle_size(parts.dimension);
  const auto has = [&](std::size_t size, const std::string& what, std::size_t must) {
    reader.rules.that(size == must, name + ": " + std::to_string(size) + " numbers of " + what +
                                        ", must be " + std::to_string(must));
  };
  has(parts.means.size(), parts.name_of_means, means);
  has(parts.covariances.size(), "covariances", covariances);
  if (reader.rules.broken())
    return std::nullopt;
  const auto k = static_cast<Eigen::Index>(parts.weights.size());
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Map<const Matrix> columns(parts.means.data(),
                                         static_cast<Eigen::Index>(parts.dimension), k);
  try {
    return Mixture(Eigen::Map<const Eigen::VectorXd>(parts.weights.data(), k),
                   columns.template cast<double>(),
                   read_triangles(parts.covariances, parts.dimension));
  } catch (const std::invalid_argument& error) {  // the class knows its own invariant
    reader.rules.that(false, error.what());
    return std::nullopt;
  }
}

}  // namespace

void check_mixture(const Mixture& mixture, Rules& rules) {
  const auto components = static_cast<std::size_t>(mixture.size());
  if (!mixture.shares_covariance()) {
    rules.at_most("mixture: components", components, kMaxComponents);
    return;
  }
  rules.at_most("kernels: components", components, kMaxKernels)
      .that(mixture.means().cast<float>().allFinite(), "kernels: a centre is no finite f32");
}

void write_mixture(const Mixture& mixture, Arena& arena, kinship_wire_Distribution& wire) {
  const auto dimension = static_cast<std::size_t>(mixture.dimension());
  const auto components = static_cast<std::size_t>(mixture.size());
  if (!mixture.shares_covariance()) {
    arena.resize(wire.mixture, 1);
    kinship_wire_Mixture& entry = wire.mixture._buffer[0];
    write_numbers(arena, mixture.weights().data(), components, entry.weights);
    write_numbers(arena, mixture.means().data(), dimension * components, entry.means);
    write_triangles(mixture.covariances(), dimension, arena, entry.covariances);
    return;
  }
  arena.resize(wire.kernels, 1);
  kinship_wire_Kernels& entry = wire.kernels._buffer[0];
  write_numbers(arena, mixture.weights().data(), components, entry.weights);
  arena.resize(entry.centres, dimension * components);
  std::transform(mixture.means().data(), mixture.means().data() + mixture.means().size(),
                 entry.centres._buffer, [](double value) { return static_cast<float>(value); });
  write_triangles(mixture.covariances(), dimension, arena, entry.covariance);
}

std::optional<Mixture> read_mixture(const kinship_wire_Distribution& wire, std::size_t dimension,
                                    Reader& reader) {
  const auto mixtures = elements(wire.mixture);
  const auto kernels = elements(wire.kernels);
  reader.rules.that(mixtures.empty() || kernels.empty(), "mixture: given, and kernels too");
  if (reader.rules.broken())
    return std::nullopt;
  if (!mixtures.empty())
    return read_parts<double>(
        {"mixture", "means", elements(mixtures[0].weights), elements(mixtures[0].means),
         elements(mixtures[0].covariances), kMaxComponents, false, dimension},
        reader);
  if (!kernels.empty())
    return read_parts<float>(
        {"kernels", "centres", elements(kernels[0].weights), elements(kernels[0].centres),
         elements(kernels[0].covariance), kMaxKernels, true, dimension},
        reader);
  return std::nullopt;
}

}  // namespace kinship::codec
