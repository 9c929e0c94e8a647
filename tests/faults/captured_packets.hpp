#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

/// What a client of ours sends over UDP, and what becomes of it in bad hands.
namespace kinship::test {

using Packet = std::vector<std::uint8_t>;

/// What a client sends that registers, reports, fetches, follows, watches and asks: of a process
/// that did all that with the server of a domain, by Cyclone DDS's own capture.
/// \throws std::runtime_error if nothing was captured.
std::vector<Packet> capture_client(std::uint32_t domain, const std::filesystem::path& folder);

/// The main function of that process: DOMAIN OUTBOX.
int run_captured_client(const std::vector<std::string>& arguments);

/// One of the packets, as it is or, mostly, with lengths, ids and bytes changed, cut or grown; or
/// submessages made up; or bytes of chance.
Packet make_garbage(const std::vector<Packet>& packets, std::mt19937_64& generator);

}  // namespace kinship::test
