#pragma once

#include <string>
#include <utility>
#include <vector>

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"

/// Lists of pairs of link or object names, [[a, b]]; for this library's sources only.
namespace kinship::json {

using NamePairs = std::vector<std::pair<std::string, std::string>>;

OrderedJson pair_list(const NamePairs& pairs);
NamePairs read_pairs(const Reader& reader);

}  // namespace kinship::json
