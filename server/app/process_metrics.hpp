#pragma once

#include "server/metrics/exposition.hpp"

namespace kinship::app {

/// What this process takes of the machine, under the names that Prometheus's own libraries use.
/// What /proc does not tell is left out.
void expose_process(metrics::Exposition& page);

}  // namespace kinship::app
