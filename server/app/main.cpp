#include <unistd.h>

#include <chrono>
#include <exception>
#include <iostream>
#include <variant>

#include "server/app/check_sites.hpp"
#include "server/app/migrate_store.hpp"
#include "server/app/offline.hpp"
#include "server/app/options.hpp"
#include "server/app/secure.hpp"
#include "server/app/serve.hpp"

int main(int argc, char** argv) {
  using namespace kinship::app;
  try {
    const Options options = parse_arguments(argc, argv, std::cout, std::cerr);
    if (const int* const code = std::get_if<int>(&options))
      return *code;
    if (const auto* const offline = std::get_if<OfflineOptions>(&options))
      return run_offline(*offline, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
    if (const auto* const move = std::get_if<MigrateStoreOptions>(&options))
      return run_migrate_store(*move, std::cout, std::cerr, isatty(STDERR_FILENO) == 1);
    if (const auto* const sites = std::get_if<CheckSitesOptions>(&options))
      return run_check_sites(*sites, std::cout, std::cerr);
    if (const auto* const secure = std::get_if<SecureOptions>(&options))
      return run_secure(*secure,
                        std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()),
                        std::cout, std::cerr);
    return serve(std::get<ServerOptions>(options), std::cout);
  } catch (const std::exception& exception) {
    std::cerr << "kinshipd: " << exception.what() << '\n';
    return kinship::kFailed;
  }
}
