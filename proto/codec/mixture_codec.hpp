#pragma once

#include <cstddef>
#include <optional>

#include "proto/codec/arena.hpp"
#include "proto/codec/reader.hpp"
#include "proto/idl/fetch.h"
#include "proto/types/mixture.hpp"

/// The part of the fetch codec that handles mixtures: as Mixture, or as Kernels if their components
/// share a covariance.
namespace kinship::codec {

void check_mixture(const Mixture& mixture, Rules& rules);

/// Means of components that share a covariance are rounded to f32, without loss if the fit already
/// made them f32 numbers.
/// \param mixture  checked by check_mixture.
void write_mixture(const Mixture& mixture, Arena& arena, kinship_wire_Distribution& wire);

/// \param dimension  d.
/// \return none if the message has none; or a rule was broken.
std::optional<Mixture> read_mixture(const kinship_wire_Distribution& wire, std::size_t dimension,
                                    Reader& reader);

}  // namespace kinship::codec
