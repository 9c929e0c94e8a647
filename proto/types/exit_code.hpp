#pragma once

#include "proto/types/failure.hpp"

/// Exit codes of every program.
namespace kinship {

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

}  // namespace kinship
