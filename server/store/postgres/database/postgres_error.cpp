#include "server/store/postgres/database/postgres_error.hpp"

namespace kinship::store::postgres {

ErrorKind kind_of(std::string_view sqlstate) {
  if (sqlstate.empty())
    return ErrorKind::Lost;
  const ErrorClass* longest = nullptr;
  for (const ErrorClass& each : kErrorClasses)
    if (sqlstate.starts_with(each.begin) &&
        (longest == nullptr || longest->begin.size() < each.begin.size()))
      longest = &each;
  return longest == nullptr ? ErrorKind::Other : longest->kind;
}

}  // namespace kinship::store::postgres
