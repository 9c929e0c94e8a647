#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

namespace kinship::test {

/// A connection of a client of 127.0.0.1 that waits no longer than a test may take.
class HttpConnection {
 public:
  /// \param url  of a server/http listener.
  explicit HttpConnection(const std::string& url) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const std::size_t begin = url.rfind(':') + 1;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(begin))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      close(socket_);
      throw std::runtime_error("no connection to " + url);
    }
  }
  ~HttpConnection() { close(socket_); }
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;

  bool send(const std::string& text) const {
    return ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL) ==
           static_cast<ssize_t>(text.size());
  }

  /// All that comes until the other side closes.
  std::string read() const {
    std::string text;
    while (read_part(text)) {
    }
    return text;
  }

  /// What comes until `end` is in it, or the other side closes.
  std::string read_until(const std::string& end) const {
    std::string text;
    while (text.find(end) == std::string::npos && read_part(text)) {
    }
    return text;
  }

 private:
  bool read_part(std::string& text) const {
    char part[4096];
    const ssize_t count = recv(socket_, part, sizeof part, 0);
    if (count > 0)
      text.append(part, static_cast<std::size_t>(count));
    return count > 0;
  }

  int socket_;
};

}  // namespace kinship::test
