#include "proto/json/store_check_json.hpp"

#include "proto/json/fields.hpp"

namespace kinship::json {

std::string to_json(const StoreCheck& check) { return write_fields(check, kStoreCheckFormat); }

}  // namespace kinship::json
