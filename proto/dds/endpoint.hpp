#pragma once

#include <dds/dds.h>

#include <memory>

namespace kinship::dds {

struct FreeEndpoint {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const noexcept {
    dds_builtintopic_free_endpoint(endpoint);
  }
};

/// Built-in topic data of a matched reader or writer. For sources of proto/dds only.
using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, FreeEndpoint>;

}  // namespace kinship::dds
