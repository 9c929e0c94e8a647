#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

#include "proto/dds/participant.hpp"
#include "proto/security/client_directory.hpp"

namespace kinship::test {

/// Options of a server in a process of its own: its arguments are DOMAIN [FOLDER], the folder of
/// `kinshipd secure init`.
inline dds::ParticipantOptions server_options(int argc, char** argv) {
  dds::ParticipantOptions options{.domain = static_cast<std::uint32_t>(std::stoul(argv[1])),
                                  .role = dds::Role::Server};
  if (argc < 3)
    return options;
  const std::filesystem::path folder = argv[2];
  options.security = folder / "server";
  const auto clients = std::make_shared<security::ClientDirectory>(folder / "clients");
  options.directory = [clients](const std::string& name) {
    return clients->caller(
        name, std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
  };
  return options;
}

}  // namespace kinship::test
