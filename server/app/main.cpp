#include <exception>
#include <iostream>
#include <variant>

#include "server/app/options.hpp"
#include "server/app/serve.hpp"

int main(int argc, char** argv) {
  using namespace kinship::app;
  try {
    const std::variant<ServerOptions, int> options =
        parse_arguments(argc, argv, std::cout, std::cerr);
    if (const int* const code = std::get_if<int>(&options))
      return *code;
    return serve(std::get<ServerOptions>(options), std::cout);
  } catch (const std::exception& exception) {
    std::cerr << "kinshipd: " << exception.what() << '\n';
    return kinship::kFailed;
  }
}
