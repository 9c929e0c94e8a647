#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <functional>
#include <memory>

#include "server/http/listener.hpp"

/// The inside of a listener; included by its sources alone.
namespace kinship::http {

/// One connection, plain or with TLS. All is done on the listener's thread, and its strong pointers
/// stay there: with the listener and in the callbacks of operations that are under way. Answers
/// hold weak ones.
class Connection {
 public:
  /// References; they outlive the connection.
  struct Surroundings {
    const Limits& limits;
    const Handler& handler;
    std::weak_ptr<boost::asio::io_context> context;  ///< it owns callbacks, and they connections
    std::function<void(const Connection&)> on_end;   ///< the listener forgets it
  };

  virtual ~Connection() = default;
  virtual void start() = 0;
  virtual void close() = 0;  ///< at once
  virtual bool is_streaming() const = 0;
};

/// \param tls  null: a plain one.
std::shared_ptr<Connection> make_connection(boost::asio::ip::tcp::socket socket,
                                            boost::asio::ssl::context* tls,
                                            const Connection::Surroundings& surroundings);

}  // namespace kinship::http
