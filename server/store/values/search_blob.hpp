#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/types/search_record.hpp"
#include "server/store/values/bytes.hpp"

namespace kinship::store {

/// A search record as bytes, compressed where that is smaller; every number is kept, poses as 7
/// numbers.
/// \param search  keeps the rules of check_search().
std::vector<std::uint8_t> encode_search(const SearchRecord& search);

/// \return empty if the bytes are no result of encode_search, or break a rule of check_search().
std::optional<SearchRecord> decode_search(Bytes bytes);

}  // namespace kinship::store
