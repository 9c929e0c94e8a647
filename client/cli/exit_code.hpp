#pragma once

#include "proto/types/conversations.hpp"
#include "proto/types/failure.hpp"

/// What the programs' exit codes mean.
namespace kinship::cli {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kWrongUsage = 2;
inline constexpr int kNotFound = 3;
inline constexpr int kNoServer = 4;

constexpr int exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidInput:
    case ErrorCode::TooLarge:
      return kWrongUsage;
    case ErrorCode::NotFound:
      return kNotFound;
    case ErrorCode::Unavailable:
      return kNoServer;
    default:
      return kFailed;
  }
}

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

}  // namespace kinship::cli
