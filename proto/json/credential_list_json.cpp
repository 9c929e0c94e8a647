#include "proto/json/credential_list_json.hpp"

#include "proto/json/fields.hpp"

namespace kinship::json {

std::string to_json(const CredentialList& list) {
  return write_fields(list, kCredentialListFormat);
}

}  // namespace kinship::json
