#include "server/console/console.hpp"

#include <algorithm>
#include <utility>

#include "server/console/assets.hpp"
#include "server/console/figures.hpp"
#include "server/console/gate.hpp"
#include "server/console/status_text.hpp"
#include "server/http/compression.hpp"
#include "server/runtime/worker_pool.hpp"

namespace kinship::console {
namespace {

constexpr std::size_t kMaxConnections = 256;
constexpr std::size_t kMaxFigures = 32;   // that wait
constexpr std::size_t kMinPacked = 1400;  // bytes: more than a packet
constexpr int kNiceness = 10;             // of the thread that makes them

http::Limits limits_of(const ConsoleOptions& options) {
  return {.connections = kMaxConnections,
          .requests = 10'000,
          .header_bytes = 16'384,
          .body_bytes = 16'384,
          .hosts = options.hosts,
          .host_option = "--console-host"};
}

/// With its body as gzip, if that is worth it and not done.
http::Reply packed(http::Reply reply) {
  const auto is_encoding = [](const auto& field) { return field.first == "Content-Encoding"; };
  if (reply.body.size() < kMinPacked || std::ranges::any_of(reply.fields, is_encoding))
    return reply;
  std::string body = http::gzip(reply.body, http::Effort::Fast);
  return http::with_gzip(std::move(reply), std::move(body));
}

unsigned status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::NotFound:
      return 404;
    case ErrorCode::InvalidInput:
      return 400;
    default:
      return 503;
  }
}

}  // namespace

class Console::Implementation {
 public:
  Implementation(http::Port port, service::Service& service, Broadcast& broadcast,
                 ConsoleOptions options)
      : options_(std::move(options)),
        broadcast_(broadcast),
        questions_(service.administration(), options_.is_admin),
        gate_(options_.token, port.address().port, port.url().starts_with("https:")),
        link_(gate_.link(port.url())),
        figures_(questions_),
        worker_({.threads = 1, .queue_limit = kMaxFigures, .niceness = kNiceness}),
        listener_(
            std::move(port),
            [this](const http::Request& request, const http::Answer& answer) {
              const bool packs = http::accepts_gzip(request);
              handle(request, [answer, packs](http::Reply reply) {
                answer(guarded(packs ? packed(std::move(reply)) : std::move(reply)));
              });
            },
            limits_of(options_)) {
    broadcast_.start([&service] { return status_text(service); });
  }

  ~Implementation() { broadcast_.stop(); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  const std::string& link() const { return link_; }

 private:
  void handle(const http::Request& request, const http::Answer& answer) {
    if (std::optional<http::Reply> stopped = gate_.stop(request))
      return answer(std::move(*stopped));
    const std::vector<std::string>& parts = request.parts;
    const bool is_api = !parts.empty() && parts.front() == "api";
    if (is_api && parts.size() == 3 && parts[1] == "rows")
      return answer_rows(questions_, options_.to_json, request, answer);
    if (request.method != "GET" && request.method != "HEAD")
      return answer(message_reply(405, "GET and HEAD only"));
    if (is_api && parts.size() == 4 && parts[1] == "figures")
      return answer_figure(parts[2], parts[3], answer);
    if (is_api && parts.size() == 2 && parts[1] == "events" && request.method == "GET")
      return answer_events(answer);
    if (is_api)
      return answer(message_reply(404, "there is no " + request.path));
    if (parts.size() == 2 && parts.front() == "assets")
      return answer_asset(parts[1], http::accepts_gzip(request), answer);
    answer({.type = "text/html; charset=utf-8", .body = assets_.shell(options_.is_admin)});
  }

  void answer_asset(const std::string& name, bool packs, const http::Answer& answer) const {
    const Asset* const asset = assets_.find(name);
    if (asset == nullptr)
      return answer(http::text_reply(404, "there is no " + name));
    http::Reply reply{.type = asset->type,
                      .fields = {{"Cache-Control", "public, max-age=31536000, immutable"}}};
    if (packs)
      return answer(http::with_gzip(std::move(reply), asset->gzipped));
    reply.body = asset->text;
    answer(std::move(reply));
  }

  void answer_figure(const std::string& kind, const std::string& name, const http::Answer& answer) {
    if (!Figures::has_kind(kind))
      return answer(message_reply(404, "no figure of kind '" + kind + "'"));
    const auto run = [this, kind, name, answer] {
      try {
        answer(json_reply(200, figures_.make(kind, name)));
      } catch (const Failure& failure) {
        answer(message_reply(status_of(failure.error().code), failure.error().message));
      } catch (const std::exception& exception) {
        answer(message_reply(503, exception.what()));
      }
    };
    const auto decline = [answer] { answer(message_reply(503, "the server is busy or stopping")); };
    if (!worker_.submit(runtime::WorkerPool::Priority::Interactive,
                        {.run = run, .abandon = decline}))
      decline();
  }

  void answer_events(const http::Answer& answer) {
    if (broadcast_.listeners() >= Broadcast::kMaxListeners)
      return answer(message_reply(503, "too many pages of the console are open"));
    answer({.type = "text/event-stream", .stream = [this](http::Send send) {
              send(std::make_shared<const std::string>("retry: 2000\n\n"));
              broadcast_.add(std::move(send));
            }});
  }

  const ConsoleOptions options_;
  Broadcast& broadcast_;
  Questions questions_;
  const Assets assets_;
  const Gate gate_;
  const std::string link_;
  Figures figures_;  // used by the worker alone
  runtime::WorkerPool worker_;
  http::Listener listener_;  // last: uses all of the above
};

Console::Console(http::Port port, service::Service& service, Broadcast& broadcast,
                 ConsoleOptions options)
    : implementation_(std::make_unique<Implementation>(std::move(port), service, broadcast,
                                                       std::move(options))) {}

Console::~Console() = default;

const std::string& Console::link() const { return implementation_->link(); }

}  // namespace kinship::console
