#include "server/app/secure.hpp"

#include <algorithm>
#include <ostream>
#include <string>

#include "proto/json/credential_list_json.hpp"
#include "proto/security/access_role.hpp"
#include "proto/security/security_folder.hpp"
#include "proto/tables/table.hpp"
#include "proto/tables/table_layout.hpp"
#include "proto/types/exit_code.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::app {
namespace {

using security::SecurityFolder;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "" : ",") + word;
  return text;
}

/// The tasks and robots that a client is narrowed to, in one cell.
std::string narrowing(const CredentialList::Row& row) {
  std::string text;
  if (!row.tasks.empty())
    text = "tasks " + joined(row.tasks);
  if (!row.robots.empty())
    text += (text.empty() ? "robots " : "; robots ") + joined(row.robots);
  return text.empty() ? "-" : text;
}

std::string state_text(const CredentialList::Row& row) {
  if (row.is_of_previous_authority)
    return row.state + ", previous authority";
  return row.state + (row.trusts_a_retired_authority ? ", trusts a retired authority" : "");
}

void print(const CredentialList& list, std::ostream& out) {
  tables::Table table({"NAME", "ROLE", "STATE", "EXPIRES", "DAYS LEFT", "NARROWED TO"});
  for (const CredentialList::Row& row : list.credentials) {
    const bool is_readable = row.state != "unreadable";
    table.add_row({row.name, is_readable ? row.role : "-", state_text(row),
                   is_readable ? time_text(row.expires_ms) : "-",
                   is_readable ? std::to_string(row.days_left) : "-",
                   is_readable ? narrowing(row) : row.message});
  }
  tables::set_table_layout(out, tables::own_layout(out));
  table.print(out);
  for (const CredentialList::Authority& authority : list.authorities)
    out << authority.name << " (" << authority.fingerprint << "), expires "
        << time_text(authority.expires_ms) << '\n';
}

void print_new_client(const security::ClientRecord& record, const SecureOptions& options,
                      std::ostream& out) {
  out << "client '" << record.name << "', role " << security::role_name(record.role)
      << ", valid until " << time_text(record.expires) << ": credentials in "
      << options.out.string() << "\nbring them to its machine, and start it with --security "
      << options.out.filename().string() << " or KINSHIP_SECURITY\n";
}

int init(const SecureOptions& options, std::chrono::sys_seconds now, std::ostream& out) {
  SecurityFolder::init(options.folder, std::chrono::days(options.days), now);
  out << "security folder " << options.folder.string()
      << "\nstart the server with: kinshipd --security " << options.folder.string()
      << "\nadmit clients with: kinshipd secure add NAME --security " << options.folder.string()
      << " --role ROLE --out FOLDER\nwho has authority/ca.key can admit anybody; it is needed "
         "for secure verbs only and may be kept elsewhere\n";
  return kDone;
}

int add(const SecurityFolder& folder, const SecureOptions& options, std::chrono::sys_seconds now,
        std::ostream& out) {
  const AccessRole role = security::read_role(options.role).value_or_throw();
  print_new_client(folder.add({.name = options.name,
                               .role = role,
                               .tasks = options.tasks,
                               .robots = options.robots,
                               .days = std::chrono::days(options.days)},
                              options.out, now),
                   options, out);
  return kDone;
}

int revoke(const SecurityFolder& folder, const SecureOptions& options, std::chrono::sys_seconds now,
           std::ostream& out) {
  if (options.former) {
    const security::ClientRecord record = folder.revoke_former(options.name);
    out << "client '" << record.name << "': its newest credentials (" << record.generation
        << ") are the only ones from now on\n";
    return kDone;
  }
  const security::ClientRecord record = folder.revoke(options.name, now);
  out << "client '" << record.name << "': revoked at " << time_text(record.revoked.value_or(now))
      << '\n';
  return kDone;
}

int list(const SecurityFolder& folder, const SecureOptions& options, std::chrono::sys_seconds now,
         std::ostream& out, std::ostream& err) {
  const CredentialList found = folder.list(now);
  if (options.json)
    out << json::to_json(found) << '\n';
  else
    print(found, out);
  const auto soon = std::count_if(found.credentials.begin(), found.credentials.end(),
                                  [](const auto& row) { return row.state == "expires soon"; });
  if (soon > 0)
    err << "kinshipd: " << soon << " of them expire within " << security::kWarnedBefore.count()
        << " days: kinshipd secure renew NAME, or renew-server\n";
  return kDone;
}

int renew_authority(SecurityFolder& folder, const SecureOptions& options,
                    std::chrono::sys_seconds now, std::ostream& out) {
  const std::chrono::days days(options.days);
  if (options.leaked) {
    const auto before = folder.replace_authority(days, now);
    out << "the new authority is the only one; the server's previous credentials are in "
        << before.string()
        << "\n1. kinshipd secure renew NAME for each client whose state is 'previous authority' in "
           "kinshipd secure list, and copy the credentials to its machine"
           "\n2. restart the server and each client: their previous credentials are refused from "
           "then on\n";
    return kDone;
  }
  const auto before = folder.renew_authority(days, now);
  out << "a second authority issues from now on; the server's previous credentials are in "
      << before.string()
      << "\n1. restart the server: it then trusts both"
         "\n2. kinshipd secure renew NAME for each client whose state is 'previous authority' in "
         "kinshipd secure list"
         "\n3. kinshipd secure retire-authority, and restart the server"
         "\n4. renew the same clients again: until then they still trust the previous authority\n";
  return kDone;
}

int retire_authority(SecurityFolder& folder, const SecureOptions& options,
                     std::chrono::sys_seconds now, std::ostream& out, std::ostream& err) {
  if (const auto names = folder.clients_of_previous_authority(now);
      !names.empty() && !options.force) {
    err << "kinshipd: retire-authority would shut out " << names.size()
        << " clients: " << joined(names) << "; renew or revoke them first, or use --force\n";
    return kFailed;
  }
  const auto key = folder.retire_authority(std::chrono::days(options.days), now);
  out << "the newer authority is the only one; restart the server\n";
  if (!key.empty())
    out << "the key of the previous one is " << key.string()
        << ": after the restart the server refuses what it signs\n";
  if (const auto names = folder.clients_that_trust_retired(now); !names.empty())
    out << "kinshipd secure renew once more for " << joined(names)
        << ": until they have the new files, anyone with that key can pose as the server to them\n";
  return kDone;
}

int run(const SecureOptions& options, std::chrono::sys_seconds now, std::ostream& out,
        std::ostream& err) {
  if (options.verb == SecureVerb::Init)
    return init(options, now, out);
  SecurityFolder folder(options.folder, options.authority_key);
  const std::chrono::days days(options.days);
  switch (options.verb) {
    case SecureVerb::Add:
      return add(folder, options, now, out);
    case SecureVerb::Renew:
      print_new_client(folder.renew(options.name, days, options.out, now), options, out);
      out << "those it has stay valid too, so that it need not stop; once its machine has the new "
             "ones: kinshipd secure revoke "
          << options.name << " --former\n";
      return kDone;
    case SecureVerb::RenewServer:
      out << "new credentials for the server, from its next start on; what it had is in "
          << folder.renew_server(days, now).string() << '\n';
      return kDone;
    case SecureVerb::Revoke:
      return revoke(folder, options, now, out);
    case SecureVerb::List:
      return list(folder, options, now, out, err);
    case SecureVerb::RenewAuthority:
      return renew_authority(folder, options, now, out);
    case SecureVerb::RetireAuthority:
      return retire_authority(folder, options, now, out, err);
    case SecureVerb::Init:
      break;
  }
  return kFailed;
}

}  // namespace

int run_secure(const SecureOptions& options, std::chrono::sys_seconds now, std::ostream& out,
               std::ostream& err) {
  try {
    return run(options, now, out, err);
  } catch (const Failure& failure) {
    err << "kinshipd: " << failure.what() << '\n';
    return exit_code(failure.code());
  }
}

}  // namespace kinship::app
