#pragma once

#include "proto/types/conversations.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship {

constexpr int exit_code(AdminStatus status) {
  switch (status) {
    case AdminStatus::Ok:
      return kDone;
    case AdminStatus::NotFound:
      return kNotFound;
    case AdminStatus::Refused:
      return kWrongUsage;
    default:
      return kFailed;
  }
}

}  // namespace kinship
