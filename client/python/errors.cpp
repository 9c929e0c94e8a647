#include "client/python/errors.hpp"

#include <pybind11/pybind11.h>

#include <cctype>
#include <cstddef>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

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

/// Options of the programs, in messages of libraries that they share, and arguments for them.
constexpr std::pair<std::string_view, std::string_view> kArguments[] = {
    {"--base", "base"},
    {"--tip", "tip"},
    {"--label", "label"},
    {"--transfer", "transfer"},
    {"--axes", "axes"},
    {"--hold", "held"},
    {"--srdf", "srdf"},
    {"--package", "packages"},
    {"--collision-from-visual", "collision_from_visual"},
    {"--without-collision", "without_collision"},
    {"--xacro-argument", "xacro"},
    {"--planner", "planner"},
    {"--clearance", "clearance"},
    {"--resolution", "resolution"}};

/// "needs --base LINK" as "needs base=LINK".
std::string with_arguments(std::string text) {
  for (const auto& [option, argument] : kArguments)
    for (std::size_t at = text.find(option); at != std::string::npos; at = text.find(option, at)) {
      const std::size_t end = at + option.size();
      const char next = end < text.size() ? text[end] : ' ';
      if (next == '-' || std::islower(static_cast<unsigned char>(next)) != 0) {
        at = end;  // a longer option
        continue;
      }
      text.replace(at, option.size(), argument);
      const std::size_t value = at + argument.size();
      if (value + 1 < text.size() && text[value] == ' ' &&
          std::isupper(static_cast<unsigned char>(text[value + 1])) != 0)
        text[value] = '=';
    }
  return text;
}

void set_error(const char* name, const std::string& text) {
  PyErr_SetString(py::module_::import("kinship.errors").attr(name).ptr(), text.c_str());
}

}  // namespace

void translate_failures() {
  // NOLINTNEXTLINE(performance-unnecessary-value-param): the type is pybind11's
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown)
        std::rethrow_exception(thrown);
    } catch (const Failure& failure) {
      set_error(class_of(failure.code()), with_arguments(failure.what()));
    } catch (const std::invalid_argument& broken) {
      set_error("InvalidInput", with_arguments(broken.what()));
    }
  });
}

void raise_error(const char* name, const std::string& text) {
  set_error(name, text);
  throw py::error_already_set();
}

void warn(const char* name, const std::string& text) {
  const std::string told = with_arguments(text);
  if (PyErr_WarnEx(py::module_::import("kinship.errors").attr(name).ptr(), told.c_str(), 1) != 0)
    throw py::error_already_set();
}

}  // namespace kinship::python
