#pragma once

#include <cstddef>

#include "proto/idl/admin.h"
#include "proto/idl/fetch.h"
#include "proto/idl/register.h"
#include "proto/idl/report.h"

/// Size of a request, from its message alone: without decoding it, and without allocating memory.
namespace kinship::codec {

struct RequestSize {
  std::size_t bytes = 0;     ///< approximate, on the network
  std::size_t attempts = 0;  ///< of a report
};

RequestSize size_of(const kinship_wire_RegisterRequest& wire);
RequestSize size_of(const kinship_wire_ReportRequest& wire);
RequestSize size_of(const kinship_wire_FetchRequest& wire);
RequestSize size_of(const kinship_wire_AdminRequest& wire);

}  // namespace kinship::codec
