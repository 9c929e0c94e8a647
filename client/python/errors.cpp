#include "client/python/errors.hpp"

#include <pybind11/pybind11.h>

#include <exception>
#include <stdexcept>

#include "proto/types/failure.hpp"

namespace kinship::python {
namespace {

namespace py = pybind11;

const char* class_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidInput:
      return "InvalidInput";
    case ErrorCode::NotFound:
      return "NotFound";
    case ErrorCode::Conflict:
      return "Conflict";
    case ErrorCode::TooLarge:
      return "TooLarge";
    case ErrorCode::Unavailable:
      return "NoServer";
    case ErrorCode::Storage:
      return "StorageError";
    case ErrorCode::Internal:
      break;
  }
  return "InternalError";
}

void set_error(const char* name, const char* text) {
  PyErr_SetString(py::module_::import("kinship.errors").attr(name).ptr(), text);
}

}  // namespace

void translate_failures() {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the type is pybind11's
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown)
        std::rethrow_exception(thrown);
    } catch (const Failure& failure) {
      set_error(class_of(failure.code()), failure.what());
    } catch (const std::invalid_argument& broken) {
      set_error("InvalidInput", broken.what());
    }
  });
}

void raise_error(const char* name, const std::string& text) {
  set_error(name, text.c_str());
  throw py::error_already_set();
}

void warn(const char* name, const std::string& text) {
  if (PyErr_WarnEx(py::module_::import("kinship.errors").attr(name).ptr(), text.c_str(), 1) != 0)
    throw py::error_already_set();
}

}  // namespace kinship::python
