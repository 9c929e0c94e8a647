#include "server/store/moving/pair_records.hpp"

#include <sstream>
#include <string>

#include "server/store/values/crc32c.hpp"

namespace kinship::store::moving {
namespace {

std::string key_of_record(const MovedRow& experience) {
  return std::string(kPairRecord) + std::to_string(integer_of(experience, 0)) + "." +
         std::to_string(integer_of(experience, 1));
}

/// Generations only grow, so that an older row never looks like a newer one.
std::string state_of_pair(const MovedRow& experience) {
  static const std::size_t generation = moved_table("experience").column("generation");
  return std::to_string(integer_of(experience, generation)) + "-" +
         std::to_string(digest_of(experience));
}

}  // namespace

std::uint32_t digest_of(const MovedRow& row, std::uint32_t before) {
  std::uint32_t digest = before;
  const auto add = [&](const void* bytes, std::size_t size) {
    digest = crc32c({static_cast<const std::uint8_t*>(bytes), size}, digest);
  };
  for (const Cell& cell : row) {
    const std::uint64_t kind = cell.index();
    add(&kind, sizeof kind);
    if (const auto* const text = std::get_if<std::string>(&cell))
      add(text->data(), text->size());
    else if (const auto* const real = std::get_if<double>(&cell))
      add(real, sizeof *real);
    else if (const auto* const integer = std::get_if<std::int64_t>(&cell))
      add(integer, sizeof *integer);
  }
  return digest;
}

std::optional<PairRecord> PairRecords::find(const MovedRow& experience) const {
  std::istringstream text(target_.setting(key_of_record(experience)));
  std::string state;
  PairRecord record;
  text >> state >> record.paths.rows >> record.paths.digest >> record.attempts.rows >>
      record.attempts.digest;
  if (!text || state != state_of_pair(experience))
    return std::nullopt;
  return record;
}

void PairRecords::put(const MovedRow& experience, const PairRecord& record) {
  std::ostringstream text;
  text << state_of_pair(experience) << ' ' << record.paths.rows << ' ' << record.paths.digest << ' '
       << record.attempts.rows << ' ' << record.attempts.digest;
  target_.in_transaction([&] { target_.put_setting(key_of_record(experience), text.str()); });
}

}  // namespace kinship::store::moving
