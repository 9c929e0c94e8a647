#include "proto/dds/self_description.hpp"

#include <dds/dds.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "proto/types/limits.hpp"

namespace kinship::dds {
namespace {

constexpr std::string_view kBegin = "kinship-client\n";

std::string printable(std::string_view text, std::size_t limit) {
  std::string kept;
  std::ranges::copy_if(text, std::back_inserter(kept), [](char c) { return c > ' ' && c < 0x7F; });
  kept.resize(std::min(kept.size(), limit));
  return kept;
}

}  // namespace

SelfDescription own_description() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0)
    host[0] = '\0';
  return {printable(host.data(), kMaxMachineBytes),
          printable(program_invocation_short_name, kMaxWordBytes)};
}

void set_description(dds_qos* qos, const SelfDescription& self) {
  const std::string text = std::string(kBegin) + self.host + '\n' + self.program;
  dds_qset_userdata(qos, text.data(), text.size());
}

std::optional<SelfDescription> self_description_of(const dds_qos* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size))
    return std::nullopt;
  const std::string text(static_cast<const char*>(data), size);
  dds_free(data);
  if (!text.starts_with(kBegin))
    return std::nullopt;
  const std::size_t end = text.find('\n', kBegin.size());
  if (end == std::string::npos)
    return std::nullopt;
  const std::string_view all = text;
  return SelfDescription{
      printable(all.substr(kBegin.size(), end - kBegin.size()), kMaxMachineBytes),
      printable(all.substr(end + 1), kMaxWordBytes)};
}

}  // namespace kinship::dds
