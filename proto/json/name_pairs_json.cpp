#include "proto/json/name_pairs_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/types/limits.hpp"

namespace kinship::json {

OrderedJson pair_list(const NamePairs& pairs) {
  OrderedJson array = OrderedJson::array();
  for (const auto& [first, second] : pairs)
    array.push_back(OrderedJson::array({first, second}));  // two strings would make an object
  return array;
}

NamePairs read_pairs(const Reader& reader) {
  NamePairs pairs;
  for (const Reader& element : reader.elements(kMaxCollisionPairs)) {
    const auto names = element.elements(2);
    if (names.size() != 2)
      element.refuse("must be two names");
    pairs.emplace_back(names[0].text(kMaxLinkNameBytes), names[1].text(kMaxLinkNameBytes));
  }
  return pairs;
}

}  // namespace kinship::json
