#include "client/cli/page_file.hpp"

#include <ostream>

namespace kinship::cli {

PageFile::PageFile(const std::filesystem::path& file, std::ostream& otherwise)
    : file_(file == "-" ? std::filesystem::path() : file), output_(file_, otherwise) {}

void PageFile::keep(std::ostream& err) {
  output_.keep();
  if (!file_.empty())
    err << "page in '" << file_.string() << "'\n";
}

}  // namespace kinship::cli
