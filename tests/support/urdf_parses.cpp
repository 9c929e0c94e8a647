#include "tests/support/urdf_parses.hpp"

#include <dlfcn.h>
#include <urdf_parser/urdf_parser.h>

#include <atomic>
#include <stdexcept>

namespace {

std::atomic<std::size_t> parses = 0;

// The linker leaves out a library that nothing refers to.
[[maybe_unused]] urdf::ModelInterfaceSharedPtr (*volatile another_function)(const std::string&) =
    &urdf::parseURDFFile;

}  // namespace

// Stands before the function of the same name in the shared library.
urdf::ModelInterfaceSharedPtr urdf::parseURDF(const std::string& text) {
  ++parses;
  using Parse = urdf::ModelInterfaceSharedPtr (*)(const std::string&);
  constexpr const char* kName =
      "_ZN4urdf9parseURDFERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE";
  const auto parse = reinterpret_cast<Parse>(dlsym(RTLD_NEXT, kName));
  if (parse == nullptr)
    throw std::runtime_error("urdfdom has another parseURDF");
  return parse(text);
}

std::size_t kinship::test::urdf_parses() { return parses; }
