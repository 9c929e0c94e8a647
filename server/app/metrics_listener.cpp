#include "server/app/metrics_listener.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <deque>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::app {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Tcp = asio::ip::tcp;
using Reply = http::response<http::string_body>;

constexpr const char* kPagePath = "/metrics";

Reply text_reply(http::status status, std::string text,
                 std::string_view type = "text/plain; charset=utf-8") {
  Reply reply(status, 11);
  reply.set(http::field::content_type, {type.data(), type.size()});
  reply.keep_alive(false);
  reply.body() = std::move(text);
  reply.prepare_payload();
  return reply;
}

/// The answer to an invalid request; nothing if no peer is left to read it.
std::optional<Reply> reply_to(const beast::error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return text_reply(http::status::request_header_fields_too_large, "the header is too large\n");
  if (error.category() == make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message)
    return text_reply(http::status::bad_request, "not a request of HTTP/1\n");
  return std::nullopt;
}

/// One connection: reads a request's header, answers, closes. Shared by the callbacks of its
/// operations, which all run on the listener's thread.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Answer = std::function<Reply(const http::request<http::empty_body>&)>;

  Connection(Tcp::socket socket, const MetricsLimits& limits, const Answer& answer)
      : stream_(std::move(socket)), buffer_(limits.header_bytes), limits_(limits), answer_(answer) {
    parser_.header_limit(static_cast<std::uint32_t>(limits.header_bytes));
  }

  void start() {
    stream_.expires_after(limits_.request_time);
    http::async_read_header(
        stream_, buffer_, parser_,
        [self = shared_from_this()](const beast::error_code& error, std::size_t) {
          if (!error)
            return self->send(self->answer_(self->parser_.get()));
          if (std::optional<Reply> reply = reply_to(error))
            self->send(std::move(*reply));
        });
  }

  void close() { stream_.close(); }

 private:
  void send(Reply reply) {
    reply_ = std::move(reply);
    serializer_.emplace(*reply_);
    stream_.expires_after(limits_.request_time);
    const auto ended = [self = shared_from_this()](const beast::error_code&, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    };
    if (!parser_.is_header_done() || parser_.get().method() != http::verb::head)
      return http::async_write(stream_, *serializer_, ended);
    http::async_write_header(stream_, *serializer_, ended);
  }

  beast::tcp_stream stream_;
  beast::flat_buffer buffer_;
  http::request_parser<http::empty_body> parser_;
  std::optional<Reply> reply_;
  std::optional<http::serializer<false, http::string_body>> serializer_;
  const MetricsLimits& limits_;
  const Answer& answer_;
};

}  // namespace

struct MetricsPort::State {
  asio::io_context context{1};
  Tcp::acceptor acceptor{context};
};

MetricsPort::MetricsPort(const MetricsAddress& address) : state_(std::make_unique<State>()) {
  try {
    const Tcp::endpoint endpoint(asio::ip::make_address(address.address), address.port);
    state_->acceptor.open(endpoint.protocol());
    state_->acceptor.set_option(Tcp::acceptor::reuse_address(true));  // of connections that ended
    state_->acceptor.bind(endpoint);
    state_->acceptor.listen(static_cast<int>(MetricsLimits().connections));
  } catch (const boost::system::system_error& error) {
    throw Failure(ErrorCode::Unavailable, "metrics cannot be served at " + to_text(address) +
                                              " (--metrics): " + error.code().message());
  }
}

MetricsPort::~MetricsPort() = default;
MetricsPort::MetricsPort(MetricsPort&& other) noexcept = default;
MetricsPort& MetricsPort::operator=(MetricsPort&& other) noexcept = default;

std::string MetricsPort::url() const {
  const Tcp::endpoint endpoint = state_->acceptor.local_endpoint();
  return "http://" + to_text({endpoint.address().to_string(), endpoint.port()}) + kPagePath;
}

class MetricsListener::Implementation {
 public:
  Implementation(MetricsPort port, std::function<std::string()> page, const MetricsLimits& limits)
      : limits_(limits),
        page_(std::move(page)),
        port_(std::move(port)),
        retry_(port_.state_->context) {
    thread_ = std::thread([this] { run(); });
  }

  ~Implementation() {
    port_.state_->context.stop();
    thread_.join();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

 private:
  static constexpr std::chrono::milliseconds kPause{200};

  void run() {
    while (!port_.state_->context.stopped())
      try {
        accept();
        port_.state_->context.run();
      } catch (const std::bad_alloc&) {  // of one connection, which ends; the others go on
        std::this_thread::sleep_for(kPause);
      }
  }

  void accept() {
    if (is_accepting_)
      return;
    port_.state_->acceptor.async_accept([this](const beast::error_code& error, Tcp::socket socket) {
      is_accepting_ = false;
      if (error)
        return accept_later();
      add(std::make_shared<Connection>(std::move(socket), limits_, answer_));
      accept();
    });
    is_accepting_ = true;
  }

  /// After an error, such as no descriptor left, which the next one would find again at once.
  void accept_later() {
    retry_.expires_after(kPause);
    retry_.async_wait([this](const beast::error_code&) { accept(); });
  }

  void add(const std::shared_ptr<Connection>& connection) {
    std::erase_if(connections_, [](const auto& other) { return other.expired(); });
    if (connections_.size() >= limits_.connections) {
      if (const auto oldest = connections_.front().lock())
        oldest->close();
      connections_.pop_front();
    }
    connections_.push_back(connection);
    connection->start();
  }

  /// No browser leaves Host out.
  bool is_for_another_host(const http::request<http::empty_body>& request) const {
    const auto hosts = request.equal_range(http::field::host);
    return std::any_of(hosts.first, hosts.second, [this](const auto& field) {
      return !is_served_host({field.value().data(), field.value().size()}, limits_.hosts);
    });
  }

  Reply answer(const http::request<http::empty_body>& request) {
    if (is_for_another_host(request))
      return text_reply(http::status::misdirected_request,
                        "this host's name is not served; kinshipd --metrics-host NAME serves it\n");
    const std::string_view target(request.target().data(), request.target().size());
    if (target.substr(0, target.find('?')) != kPagePath)
      return text_reply(http::status::not_found, std::string("there is ") + kPagePath + " only\n");
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      Reply reply = text_reply(http::status::method_not_allowed, "GET and HEAD only\n");
      reply.set(http::field::allow, "GET, HEAD");
      return reply;
    }
    try {
      return text_reply(http::status::ok, current_page(),
                        "text/plain; version=0.0.4; charset=utf-8");
    } catch (const std::exception& exception) {
      return text_reply(http::status::service_unavailable, std::string(exception.what()) + '\n');
    }
  }

  const std::string& current_page() {
    const auto now = std::chrono::steady_clock::now();
    if (!made_ || now - *made_ >= limits_.page_age) {
      text_ = page_();
      made_ = now;
    }
    return text_;
  }

  const MetricsLimits limits_;
  const std::function<std::string()> page_;
  const Connection::Answer answer_ = [this](const auto& request) { return answer(request); };
  std::string text_;
  std::optional<std::chrono::steady_clock::time_point> made_;
  std::deque<std::weak_ptr<Connection>> connections_;  // the oldest one first
  MetricsPort port_;                                   // the members above outlive its callbacks
  asio::steady_timer retry_;
  bool is_accepting_ = false;
  std::thread thread_;  // last: uses all of the above
};

MetricsListener::MetricsListener(MetricsPort port, std::function<std::string()> page,
                                 MetricsLimits limits)
    : implementation_(std::make_unique<Implementation>(std::move(port), std::move(page), limits)) {}

MetricsListener::~MetricsListener() = default;

}  // namespace kinship::app
