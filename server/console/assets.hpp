#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kinship::console {

/// A file that browsers load.
struct Asset {
  std::string name;  ///< tables.js
  std::string_view text;
  std::string gzipped;  ///< its text as gzip
  std::string type;     ///< of its content
  std::string version;  ///< of its text: in its address, so that it may be kept for ever
};

/// The files of the console's pages and those of figures, which are loaded when one is shown.
class Assets {
 public:
  Assets();

  /// Null if there is none of that name.
  const Asset* find(std::string_view name) const;

  /// The page that every address of the console shows; its script then shows what the address asks
  /// for.
  std::string shell(bool is_admin) const;

 private:
  void add(std::string_view name, std::string_view text);
  std::string address_of(std::string_view name) const;

  std::vector<Asset> assets_;
};

}  // namespace kinship::console
