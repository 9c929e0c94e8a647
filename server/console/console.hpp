#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/console/broadcast.hpp"
#include "server/console/rows.hpp"
#include "server/http/listener.hpp"
#include "server/service/service.hpp"

namespace kinship::console {

struct ConsoleOptions {
  std::string token;               ///< letters and digits, which let a browser in
  bool is_admin = false;           ///< may change something
  std::vector<std::string> hosts;  ///< names by which it may be asked for, see is_served_host()
  RowText to_json;                 ///< a row as `--json` has it
};

/// The live console: pages in a browser, at a port. Nothing of it waits for the store on the port's
/// thread.
class Console {
 public:
  /// \param service, broadcast  outlive the console; the broadcast is the one that the service's
  ///                            events go to.
  Console(http::Port port, service::Service& service, Broadcast& broadcast, ConsoleOptions options);
  ~Console();  ///< returns when no figure is being made
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// That lets a browser in.
  const std::string& link() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::console
