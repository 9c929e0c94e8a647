#pragma once

#include "server/metrics/exposition.hpp"

namespace kinship::app {

/// Resource use of this process, under the names that Prometheus's own libraries use. Values that
/// /proc does not give are left out.
void expose_process(metrics::Exposition& page);

}  // namespace kinship::app
