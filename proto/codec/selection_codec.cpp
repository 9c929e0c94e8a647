#include "proto/codec/selection_codec.hpp"

#include <algorithm>
#include <functional>

#include "proto/codec/writer.hpp"
#include "proto/types/limits.hpp"

namespace kinship::codec {
namespace {

constexpr std::size_t kDigestBytes = 32;

}  // namespace

Rules& check_selection(const Selection& selection, Rules& rules) {
  const std::vector<Digest>& sources = selection.sources;
  return rules.at_most("sources of the selection", sources.size(), kMaxSelectedSources)
      .that(std::adjacent_find(sources.begin(), sources.end(), std::greater_equal<>()) ==
                sources.end(),
            "sources of the selection: not ascending and distinct")
      .that(selection.since_ms >= 0,
            "since (ms): " + std::to_string(selection.since_ms) + " is negative");
}

void write_part(const Selection& selection, Arena& arena, SelectionMember& wire) {
  if (selection == Selection{})
    return;
  arena.resize(wire, 1);
  kinship_wire_Selection& entry = wire._buffer[0];
  arena.resize(entry.sources, kDigestBytes * selection.sources.size());
  std::uint8_t* next = entry.sources._buffer;
  for (const Digest& source : selection.sources)
    next = std::copy(source.bytes.begin(), source.bytes.end(), next);
  entry.weighting = selection.weighting ? 1 + static_cast<std::uint32_t>(*selection.weighting) : 0;
  entry.since_ms = selection.since_ms;
}

void read_part(const SelectionMember& wire, Reader& reader, Selection& selection) {
  const auto entries = elements(wire);
  if (entries.empty())
    return;
  const kinship_wire_Selection& entry = entries[0];
  const auto bytes = elements(entry.sources);
  reader.rules
      .that(bytes.size() % kDigestBytes == 0,
            "sources of the selection: " + std::to_string(bytes.size()) +
                " bytes are not a multiple of 32")
      .at_most("sources of the selection", bytes.size() / kDigestBytes, kMaxSelectedSources)
      .between("weighting", entry.weighting, 0, 1 + static_cast<double>(Weighting::Paths));
  if (reader.rules.broken())
    return;
  selection.sources.resize(bytes.size() / kDigestBytes);
  for (std::size_t i = 0; i < selection.sources.size(); ++i)
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(kDigestBytes * i), kDigestBytes,
                selection.sources[i].bytes.begin());
  if (entry.weighting > 0)
    selection.weighting = static_cast<Weighting>(entry.weighting - 1);
  selection.since_ms = entry.since_ms;
}

}  // namespace kinship::codec
