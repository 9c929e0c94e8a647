#include "server/store/postgres/database/connection_string.hpp"

#include <libpq-fe.h>

#include <algorithm>
#include <memory>

#include "proto/types/failure.hpp"

namespace kinship::store::postgres {
namespace {

struct FreeOptions {
  void operator()(PQconninfoOption* options) const noexcept { PQconninfoFree(options); }
};

std::vector<std::string> parts_of(const std::string& list) {
  std::vector<std::string> parts(1);
  for (const char each : list) {
    if (each == ',')
      parts.emplace_back();
    else
      parts.back() += each;
  }
  return parts;
}

/// As a URL has them: "a:5432,b:5433"; one port is that of all.
std::string hosts_and_ports(const std::string& hosts, const std::string& ports) {
  const std::vector<std::string> all_ports = parts_of(ports);
  std::string text;
  std::size_t number = 0;
  for (const std::string& host : parts_of(hosts)) {
    const std::string& port = all_ports[std::min(number, all_ports.size() - 1)];
    const bool is_ipv6 = host.find(':') != std::string::npos;
    text += (number++ == 0 ? "" : ",") + (is_ipv6 ? "[" + host + "]" : host) +
            (port.empty() ? "" : ":" + port);
  }
  return text;
}

}  // namespace

bool is_connection_string(std::string_view text) {
  return text.starts_with("postgresql://") || text.starts_with("postgres://");
}

ConnectionString::ConnectionString(const std::string& text) {
  char* why = nullptr;
  const std::unique_ptr<PQconninfoOption, FreeOptions> options(PQconninfoParse(text.c_str(), &why));
  PQfreemem(why);  // it may repeat a part of the text, and with it a password
  if (!options || !is_connection_string(text))
    throw Failure(ErrorCode::InvalidInput,
                  "the store's address is no connection string that libpq can read; it looks like "
                  "postgresql://USER@HOST:PORT/DATABASE?sslmode=verify-full, with special "
                  "characters written as %XX");
  for (const PQconninfoOption* option = options.get(); option->keyword != nullptr; ++option) {
    if (option->val == nullptr)
      continue;
    parameters_.emplace_back(option->keyword, option->val);
    // libpq marks options with a star whose values are hidden while they are typed.
    if (std::string_view(option->dispchar) == "*" && *option->val != '\0')
      secrets_.emplace_back(option->val);
  }
  set_default("client_encoding", "UTF8");
  set_default("fallback_application_name", "kinshipd");
  set_default("connect_timeout", "3");
  set_default("keepalives_idle", "10");
  set_default("keepalives_interval", "5");
  set_default("keepalives_count", "3");
  set_default("tcp_user_timeout", "20000");
  describe();
}

void ConnectionString::describe() {
  const std::string user = value_of("user");
  const std::string host = value_of("host").empty() ? value_of("hostaddr") : value_of("host");
  description_ = "postgresql://" + (user.empty() ? "" : user + "@") +
                 hosts_and_ports(host, value_of("port")) + "/" + value_of("dbname");
}

std::vector<ConnectionString> ConnectionString::each_host() const {
  const auto count =
      static_cast<std::size_t>(1 + std::max(std::ranges::count(value_of("host"), ','),
                                            std::ranges::count(value_of("hostaddr"), ',')));
  std::vector<ConnectionString> hosts(count, *this);
  for (std::size_t i = 0; i < count && count > 1; ++i) {
    for (const std::string_view keyword : {"host", "hostaddr", "port"}) {
      const std::vector<std::string> values = parts_of(value_of(keyword));
      if (values.size() > 1)  // one port is that of all
        hosts[i].set(keyword, values[std::min(i, values.size() - 1)]);
    }
    hosts[i].describe();
  }
  return hosts;
}

ConnectionString ConnectionString::to_any_role() const {
  ConnectionString any = *this;
  any.set("target_session_attrs", "any");
  return any;
}

void ConnectionString::set(std::string_view keyword, const std::string& value) {
  for (auto& [known, old] : parameters_)
    if (known == keyword)
      old = value;
}

void ConnectionString::set_default(std::string_view keyword, std::string_view value) {
  if (value_of(keyword).empty())
    parameters_.emplace_back(keyword, value);
}

std::string ConnectionString::value_of(std::string_view keyword) const {
  const auto found =
      std::ranges::find(parameters_, keyword, &std::pair<std::string, std::string>::first);
  return found == parameters_.end() ? std::string() : found->second;
}

std::string ConnectionString::without_secrets(std::string message) const {
  for (const std::string& secret : secrets_)
    for (std::size_t at = message.find(secret); at != std::string::npos;
         at = message.find(secret, at))
      message.replace(at, secret.size(), "*");
  return message;
}

}  // namespace kinship::store::postgres
