#include "client/cli/empty_outbox.hpp"

#include <cstdlib>
#include <string>
#include <system_error>

#include "proto/types/failure.hpp"

namespace kinship::cli {

EmptyOutbox::EmptyOutbox() {
  std::error_code error;
  const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
  std::string pattern = (parent / "kinship_XXXXXX").string();
  if (error || mkdtemp(pattern.data()) == nullptr)
    throw Failure(ErrorCode::Storage, "outbox '" + pattern + "' cannot be made");
  folder_ = pattern;
}

EmptyOutbox::~EmptyOutbox() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

}  // namespace kinship::cli
