#pragma once

#include "pages/plots/attempt_figure.hpp"
#include "proto/types/attempt.hpp"

namespace kinship::plots {

/// Whether another attempt of a figure's robot was asked the same, whatever both found: from one
/// start configuration and base pose to one pose of the transfer frame, 1 mm and 0.01 rad near,
/// among the same objects and with the same held. False where one keeps neither path nor search
/// record.
bool is_same_query(const AttemptFigure& figure, const Attempt& other);

}  // namespace kinship::plots
