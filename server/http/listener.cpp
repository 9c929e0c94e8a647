#include "server/http/listener.hpp"

#include <algorithm>
#include <boost/asio/steady_timer.hpp>
#include <list>
#include <thread>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/http/connection.hpp"

namespace kinship::http {
namespace {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using boost::system::error_code;
using boost::system::system_error;

std::unique_ptr<asio::ssl::context> read_certificate(const CertificateFiles& files) {
  auto tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
  tls->set_options(asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1);
  tls->use_certificate_chain_file(files.certificate.string());
  tls->use_private_key_file(files.key.string(), asio::ssl::context::pem);
  return tls;
}

}  // namespace

struct Port::State {
  /// Shared with answers, which may come after the listener has ended.
  std::shared_ptr<asio::io_context> context = std::make_shared<asio::io_context>(1);
  Tcp::acceptor acceptor{*context};
  std::unique_ptr<asio::ssl::context> tls;  // null: plain
};

Port::Port(const Address& address, const PortUse& use) : state_(std::make_unique<State>()) {
  try {
    const Tcp::endpoint endpoint(asio::ip::make_address(address.address), address.port);
    state_->acceptor.open(endpoint.protocol());
    state_->acceptor.set_option(Tcp::acceptor::reuse_address(true));  // of connections that ended
    state_->acceptor.bind(endpoint);
    state_->acceptor.listen();
    if (use.tls)
      state_->tls = read_certificate(*use.tls);
  } catch (const system_error& error) {
    throw Failure(ErrorCode::Unavailable, use.what + " cannot be served at " + to_text(address) +
                                              " (" + use.option + "): " + error.code().message());
  }
}

Port::~Port() = default;
Port::Port(Port&& other) noexcept = default;
Port& Port::operator=(Port&& other) noexcept = default;

Address Port::address() const {
  const Tcp::endpoint endpoint = state_->acceptor.local_endpoint();
  return {endpoint.address().to_string(), endpoint.port()};
}

std::string Port::url() const {
  Address named = address();
  if (state_->acceptor.local_endpoint().address().is_unspecified())
    named.address = name_of_this_machine();
  return (state_->tls ? "https://" : "http://") + to_text(named);
}

class Listener::Implementation {
 public:
  Implementation(Port port, Handler handler, Limits limits)
      : limits_(std::move(limits)),
        handler_(std::move(handler)),
        port_(std::move(port)),
        retry_(*port_.state_->context) {
    thread_ = std::thread([this] { run(); });
  }

  ~Implementation() {
    port_.state_->context->stop();
    thread_.join();
    while (!connections_.empty())  // an end takes it out
      std::shared_ptr<Connection>(connections_.front())->close();
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

 private:
  static constexpr std::chrono::milliseconds kPause{200};

  void run() {
    while (!port_.state_->context->stopped())
      try {
        accept();
        port_.state_->context->run();
      } catch (const std::bad_alloc&) {  // of one connection, which ends; the others go on
        std::this_thread::sleep_for(kPause);
      }
  }

  void accept() {
    if (is_accepting_)
      return;
    port_.state_->acceptor.async_accept([this](const error_code& error, Tcp::socket socket) {
      is_accepting_ = false;
      if (error)
        return accept_later();
      make_room();
      connections_.push_back(make_connection(std::move(socket), port_.state_->tls.get(),
                                             {limits_, handler_, port_.state_->context,
                                              [this](const Connection& ended) { forget(ended); }}));
      std::shared_ptr<Connection>(connections_.back())->start();
      accept();
    });
    is_accepting_ = true;
  }

  /// After an error, such as no descriptor left, which the next one would find again at once.
  void accept_later() {
    retry_.expires_after(kPause);
    retry_.async_wait([this](const error_code&) { accept(); });
  }

  void make_room() {
    if (connections_.size() < limits_.connections)
      return;
    const auto oldest =
        std::ranges::find_if(connections_, [](const auto& each) { return !each->is_streaming(); });
    std::shared_ptr<Connection>(oldest == connections_.end() ? connections_.front() : *oldest)
        ->close();
  }

  void forget(const Connection& ended) {
    std::erase_if(connections_, [&](const auto& each) { return each.get() == &ended; });
  }

  const Limits limits_;
  const Handler handler_;
  std::list<std::shared_ptr<Connection>> connections_;  // the oldest one first
  Port port_;                                           // the members above outlive its callbacks
  asio::steady_timer retry_;
  bool is_accepting_ = false;
  std::thread thread_;  // last: uses all of the above
};

Listener::Listener(Port port, Handler handler, Limits limits)
    : implementation_(std::make_unique<Implementation>(std::move(port), std::move(handler),
                                                       std::move(limits))) {}

Listener::~Listener() = default;

}  // namespace kinship::http
