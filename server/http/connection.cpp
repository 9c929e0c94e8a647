#include "server/http/connection.hpp"

#include <array>
#include <atomic>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <cctype>
#include <deque>
#include <optional>
#include <utility>

#include "server/http/address.hpp"

namespace kinship::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Plain = beast::tcp_stream;
using Secured = beast::ssl_stream<beast::tcp_stream>;
using Parser = http::request_parser<http::string_body>;
using Part = std::shared_ptr<const std::string>;

std::string text_of(boost::string_view text) { return {text.data(), text.size()}; }

/// The answer to an invalid request; nothing if no peer is left to read it.
std::optional<Reply> reply_to(const beast::error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return text_reply(431, "the header is too large");
  if (error == http::error::body_limit)
    return text_reply(413, "the body is too large");
  if (error.category() == make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message)
    return text_reply(400, "not a request of HTTP/1");
  return std::nullopt;
}

Result<Request> request_of(const Parser::value_type& message) {
  Request request;
  request.method = text_of(message.method_string());
  request.body = message.body();
  for (const auto& field : message) {
    std::string name = text_of(field.name_string());
    for (char& letter : name)
      letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    std::string value = text_of(field.value());
    const auto [known, is_new] = request.fields.try_emplace(std::move(name), value);
    if (!is_new)
      known->second += ", " + value;
  }
  return with_target(std::move(request), text_of(message.target()));
}

/// No browser leaves Host out.
bool is_for_another_host(const Request& request, const std::vector<std::string>& names) {
  const std::string* const host = request.field("host");
  return host != nullptr && !is_served_host(*host, names);
}

std::string header_of(const Reply& reply, bool keeps_alive) {
  std::string text = "HTTP/1.1 " + std::to_string(reply.status) + ' ' +
                     text_of(http::obsolete_reason(http::int_to_status(reply.status))) +
                     "\r\nContent-Type: " + reply.type + "\r\n";
  for (const auto& [name, value] : reply.fields)
    text += name + ": " + value + "\r\n";
  if (!reply.stream)
    text += "Content-Length: " + std::to_string(reply.body.size()) + "\r\n";
  return text + "Connection: " + (keeps_alive ? "keep-alive" : "close") + "\r\n\r\n";
}

template <typename Transport>
class ConnectionOver final : public Connection,
                             public std::enable_shared_from_this<ConnectionOver<Transport>> {
 public:
  ConnectionOver(Transport transport, Surroundings surroundings)
      : transport_(std::move(transport)),
        with_(std::move(surroundings)),
        buffer_(with_.limits.header_bytes + with_.limits.body_bytes) {}

  void start() override {
    tcp().expires_after(with_.limits.request_time);
    if constexpr (std::is_same_v<Transport, Secured>)
      transport_.async_handshake(asio::ssl::stream_base::server,
                                 [self = this->shared_from_this()](const beast::error_code& error) {
                                   error ? self->end() : self->read();
                                 });
    else
      read();
  }

  void close() override { end(); }
  bool is_streaming() const override { return is_streaming_; }

 private:
  beast::tcp_stream& tcp() { return beast::get_lowest_layer(transport_); }

  void end() {
    if (has_ended_)
      return;
    has_ended_ = true;
    is_open_->store(false);
    tcp().close();
    with_.on_end(*this);
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(with_.limits.header_bytes));
    parser_->body_limit(with_.limits.body_bytes);
    http::async_read(transport_, buffer_, *parser_,
                     [self = this->shared_from_this()](const beast::error_code& error,
                                                       std::size_t) { self->take(error); });
  }

  void take(const beast::error_code& error) {
    ++requests_;
    keeps_alive_ = !error && parser_->get().keep_alive() && requests_ < with_.limits.requests;
    if (error) {
      std::optional<Reply> reply = reply_to(error);
      return reply ? write(std::move(*reply)) : end();
    }
    const Result<Request> request = request_of(parser_->get());
    if (!request)
      return write(text_reply(400, request.error().message));
    if (is_for_another_host(*request, with_.limits.hosts))
      return write(text_reply(421, "this host's name is not served; kinshipd " +
                                       with_.limits.host_option + " NAME serves it"));
    try {
      with_.handler(*request, answer());
    } catch (const std::bad_alloc&) {
      end();
      throw;
    } catch (const std::exception& exception) {
      if (!has_answered())
        write(text_reply(503, exception.what()));
    }
  }

  /// A second call, or one for an earlier request, does nothing.
  Answer answer() {
    return [weak = this->weak_from_this(), context = with_.context.lock(),
            request = requests_](Reply reply) {
      asio::dispatch(*context, [weak, request, reply = std::move(reply)]() mutable {
        const auto self = weak.lock();
        if (self && self->requests_ == request && !self->has_answered())
          self->write(std::move(reply));
      });
    };
  }

  bool has_answered() const { return has_ended_ || answered_ == requests_; }

  void write(Reply reply) {
    answered_ = requests_;
    reply_ = std::move(reply);
    keeps_alive_ = keeps_alive_ && !reply_.stream;
    header_ = header_of(reply_, keeps_alive_);
    if (parser_ && parser_->is_header_done() && parser_->get().method() == http::verb::head)
      reply_.body.clear();
    tcp().expires_after(with_.limits.request_time);
    asio::async_write(transport_, std::array{asio::buffer(header_), asio::buffer(reply_.body)},
                      [self = this->shared_from_this()](const beast::error_code& error,
                                                        std::size_t) { self->go_on(error); });
  }

  void go_on(const beast::error_code& error) {
    if (error || has_ended_)
      return end();
    if (reply_.stream)
      return begin_stream();
    if (keeps_alive_) {
      tcp().expires_after(with_.limits.idle_time);
      return read();
    }
    beast::error_code ignored;
    tcp().socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    end();
  }

  void begin_stream() {
    is_streaming_ = true;
    reply_.stream([weak = this->weak_from_this(), context = with_.context.lock(),
                   is_open = is_open_](const Part& part) {
      if (is_open->load())
        asio::post(*context, [weak, part] {
          if (const auto self = weak.lock())
            self->add(part);
        });
      return is_open->load();
    });
  }

  void add(const Part& part) {
    if (has_ended_)
      return;
    waiting_bytes_ += part->size();
    if (waiting_bytes_ > with_.limits.stream_bytes)
      return end();  // its reader is too slow
    parts_.push_back(part);
    if (parts_.size() == 1)
      write_part();
  }

  void write_part() {
    tcp().expires_after(with_.limits.request_time);
    asio::async_write(
        transport_, asio::buffer(*parts_.front()),
        [self = this->shared_from_this()](const beast::error_code& error, std::size_t) {
          if (error || self->has_ended_)
            return self->end();
          self->waiting_bytes_ -= self->parts_.front()->size();
          self->parts_.pop_front();
          if (!self->parts_.empty())
            self->write_part();
        });
  }

  Transport transport_;
  const Surroundings with_;
  beast::flat_buffer buffer_;
  std::optional<Parser> parser_;
  Reply reply_;
  std::string header_;
  std::size_t requests_ = 0, answered_ = 0;  // the number of the last one
  bool keeps_alive_ = false, has_ended_ = false, is_streaming_ = false;
  std::deque<Part> parts_;         // the first one is being written
  std::size_t waiting_bytes_ = 0;  // of them
  const std::shared_ptr<std::atomic<bool>> is_open_ = std::make_shared<std::atomic<bool>>(true);
};

}  // namespace

std::shared_ptr<Connection> make_connection(asio::ip::tcp::socket socket, asio::ssl::context* tls,
                                            const Connection::Surroundings& surroundings) {
  if (tls == nullptr)
    return std::make_shared<ConnectionOver<Plain>>(Plain(std::move(socket)), surroundings);
  return std::make_shared<ConnectionOver<Secured>>(Secured(Plain(std::move(socket)), *tls),
                                                   surroundings);
}

}  // namespace kinship::http
