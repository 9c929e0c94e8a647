#include "client/c/errors.hpp"

#include <exception>
#include <stdexcept>

namespace kinship::c_library {
namespace {

// A caller in another language has a thread and no place for a text.
thread_local std::string last_error_text;

kinship_code code_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidInput:
      return KINSHIP_INVALID_INPUT;
    case ErrorCode::NotFound:
      return KINSHIP_NOT_FOUND;
    case ErrorCode::Conflict:
      return KINSHIP_CONFLICT;
    case ErrorCode::TooLarge:
      return KINSHIP_TOO_LARGE;
    case ErrorCode::Unavailable:
      return KINSHIP_UNAVAILABLE;
    case ErrorCode::Storage:
      return KINSHIP_STORAGE;
    case ErrorCode::Internal:
      break;
  }
  return KINSHIP_INTERNAL;
}

}  // namespace

kinship_code remember(kinship_code code, const std::string& text) noexcept {
  try {
    last_error_text = text;
  } catch (...) {
    last_error_text.clear();  // no memory for the text; the code says what matters
  }
  return code;
}

kinship_code remember(const Error& error) noexcept {
  return remember(code_of(error.code), error.message);
}

kinship_code guarded(const std::function<kinship_code()>& body) noexcept {
  try {
    return body();
  } catch (const Failure& failure) {
    return remember(code_of(failure.code()), failure.what());
  } catch (const std::invalid_argument& error) {
    return remember(KINSHIP_INVALID_INPUT, error.what());
  } catch (const std::exception& error) {
    return remember(KINSHIP_INTERNAL, error.what());
  } catch (...) {
    return remember(KINSHIP_INTERNAL, "something was thrown that is no exception");
  }
}

void require(const void* argument, const char* name) {
  if (argument == nullptr)
    throw Failure(invalid_input(std::string(name) + " is NULL"));
}

}  // namespace kinship::c_library

const char* kinship_version() { return KINSHIP_VERSION; }

const char* kinship_error_text() { return kinship::c_library::last_error_text.c_str(); }
