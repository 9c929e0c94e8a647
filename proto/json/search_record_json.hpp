#pragma once

#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/search_record.hpp"

/// Search records, parts of attempts; for this library's sources only.
namespace kinship::json {

OrderedJson search_record_object(const SearchRecord& search);
SearchRecord read_search_record(const Reader& reader);

}  // namespace kinship::json
