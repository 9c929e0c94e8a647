#include "proto/codec/rehearsal_codec.hpp"

#include <string>

#include "proto/codec/fetch_codec.hpp"
#include "proto/codec/fields.hpp"

namespace kinship::codec {

template <>
struct WireMember<std::vector<GuideCost>> {
  using Type = dds_sequence_kinship_wire_GuideCost;
};

namespace {

constexpr const char* kOfRehearsal = " of a rehearsal";

}  // namespace

std::optional<Error> validate(const Rehearsal& rehearsal) {
  Rules rules;
  check_fields(rehearsal, rules, kOfRehearsal);
  for (const GuideCost& cost : rehearsal.costs)
    if (cost.solved > cost.plans)
      rules.that(false, "rehearsal: " + std::string(to_text(cost.guide)) + ": " +
                            std::to_string(cost.solved) + " solved of " +
                            std::to_string(cost.plans));
  return rules.broken();
}

void write_part(const Rehearsal& rehearsal, Arena& arena, kinship_wire_Rehearsal& wire) {
  write_fields(rehearsal, arena, wire);
}

void read_part(const kinship_wire_Rehearsal& wire, Reader& reader, Rehearsal& rehearsal) {
  rehearsal = read_fields<Rehearsal>(wire, reader, kOfRehearsal);
}

}  // namespace kinship::codec
