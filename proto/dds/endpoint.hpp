#pragma once

#include <dds/dds.h>

#include <memory>
#include <string_view>

namespace kinship::dds {

struct FreeEndpoint {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const noexcept {
    dds_builtintopic_free_endpoint(endpoint);
  }
};

/// Built-in topic data of a matched reader or writer. For sources of proto/dds only.
using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, FreeEndpoint>;

/// Cyclone DDS sets that text itself, whatever a participant announces.
inline bool is_in_this_process(const dds_builtintopic_participant_t& participant) {
  char* addresses = nullptr;
  if (!dds_qget_prop(participant.qos, "__NetworkAddresses", &addresses))
    return false;
  const bool is_here = std::string_view(addresses) == "localprocess";
  dds_free(addresses);
  return is_here;
}

}  // namespace kinship::dds
