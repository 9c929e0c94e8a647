#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace kinship {

/// Kind of an error; determines exit codes and wire statuses.
enum class ErrorCode {
  InvalidInput,  ///< a value from outside breaks a rule
  NotFound,      ///< a named robot, task, path or distribution does not exist
  Conflict,      ///< a label is taken, a UUID was used for another body
  TooLarge,      ///< a size limit is exceeded
  Unavailable,   ///< no answer, or the server is busy
  Storage,       ///< the database or a file failed
  Internal,      ///< a bug, or an unexpected result of a library
};

/// A reason as a value. The message names the thing, its value and the limit.
struct Error {
  ErrorCode code = ErrorCode::Internal;
  std::string message;
};

/// The error of a value from outside that breaks a rule.
inline Error invalid_input(std::string message) {
  return {ErrorCode::InvalidInput, std::move(message)};
}

/// Ends the current request; caught once, in the dispatcher or in main.
class Failure : public std::runtime_error {
 public:
  Failure(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  explicit Failure(const Error& error) : Failure(error.code, error.message) {}

  ErrorCode code() const noexcept { return code_; }
  Error error() const { return {code_, what()}; }

 private:
  ErrorCode code_;
};

}  // namespace kinship
