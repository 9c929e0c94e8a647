#include "server/app/secure_options.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "proto/security/access_role.hpp"
#include "proto/security/security_folder.hpp"

namespace kinship::app {
namespace {

constexpr const char* kSecureFooter =
    R"(Run as the user that kinshipd runs as. Keys are made readable for that user only, never printed and never
overwritten. Exit codes: 0 done, 1 failed, 2 wrong usage, 3 no such client or folder.

Examples:
  kinshipd secure init /var/lib/kinship/security
  kinshipd secure add arm_7 --security /var/lib/kinship/security --role robot --out arm_7
  kinshipd secure list --security /var/lib/kinship/security)";

/// As CLI::IsMember, for completions, but suggests the nearest name.
CLI::Validator is_role() {
  std::string names;
  for (const std::string& name : security::role_names())
    names += (names.empty() ? "" : ",") + name;
  return {[](std::string& text) {
            const Result<AccessRole> role = security::read_role(text);
            return role ? std::string() : role.error().message;
          },
          "{" + names + "}"};
}

/// One verb below `secure`, and the options that it fills.
class SecureCommand {
 public:
  SecureCommand(CLI::App& secure, std::optional<SecureOptions>& chosen, const char* name,
                SecureVerb verb, const char* description)
      : options_(std::make_shared<SecureOptions>()),
        command_(secure.add_subcommand(name, description)->configurable(false)) {
    options_->verb = verb;
    command_->callback([options = options_, &chosen] { chosen = *options; });
  }

  SecureCommand& folder() {
    command_->add_option("--security", options_->folder, "Security folder, from secure init")
        ->envname("KINSHIP_SECURITY")
        ->type_name("FOLDER")
        ->required();
    return *this;
  }

  SecureCommand& new_folder() {
    command_
        ->add_option("FOLDER", options_->folder, "Security folder; must be empty or not be there")
        ->type_name("FOLDER")
        ->required();
    return *this;
  }

  SecureCommand& authority_key() {
    command_
        ->add_option("--authority-key", options_->authority_key,
                     "The authority's key, if it is kept elsewhere")
        ->type_name("FILE");
    return *this;
  }

  SecureCommand& name() {
    command_->add_option("NAME", options_->name, "Client: letters, digits, _ and -")->required();
    return *this;
  }

  SecureCommand& rights() {
    command_
        ->add_option("--role", options_->role,
                     "What it may: robot (register, report, fetch, follow), reader (fetch, "
                     "list, show), operator (also retire, reset, evict, jobs, backup), admin "
                     "(everything)")
        ->check(is_role())
        ->required();
    command_
        ->add_option("--task", options_->tasks,
                     "Pattern of tasks it is narrowed to, with * and ?; may be repeated; "
                     "default: all")
        ->allow_extra_args(false);
    command_
        ->add_option("--robot", options_->robots,
                     "Label of a robot it is narrowed to; may be repeated; default: all")
        ->allow_extra_args(false);
    return *this;
  }

  SecureCommand& days(const char* of_what) {
    command_->add_option("--days", options_->days, of_what)
        ->check(CLI::Range(1, static_cast<int>(security::kMaxDays.count())))
        ->capture_default_str();
    return *this;
  }

  SecureCommand& out() {
    command_
        ->add_option("--out", options_->out,
                     "Folder for its credentials; must be empty or not be there")
        ->type_name("FOLDER")
        ->required();
    return *this;
  }

  SecureCommand& flag(const char* name, bool SecureOptions::*member, const char* description) {
    command_->add_flag(name, (*options_).*member, description);
    return *this;
  }

  void example(const std::string& text) { command_->footer("Example:\n  " + text); }

 private:
  std::shared_ptr<SecureOptions> options_;  // this one's, and of the callback that CLI11 keeps
  CLI::App* command_;
};

constexpr const char* kClientDays = "Days until they expire";
constexpr const char* kServerDays = "Days until the server's expire";

/// Verbs about clients.
void add_client_verbs(CLI::App& secure, std::optional<SecureOptions>& chosen) {
  SecureCommand(secure, chosen, "add", SecureVerb::Add,
                "Admit a client: its record and credentials")
      .name()
      .folder()
      .rights()
      .days(kClientDays)
      .out()
      .authority_key()
      .example(
          "kinshipd secure add arm_7 --security DIR --role robot --task 'shelf_*' --robot arm_7 "
          "--out arm_7");
  SecureCommand(
      secure, chosen, "renew", SecureVerb::Renew,
      "New credentials for a client that there is; those it has stay valid (revoke --former)")
      .name()
      .folder()
      .days(kClientDays)
      .out()
      .authority_key()
      .example("kinshipd secure renew arm_7 --security DIR --out arm_7-2027");
  SecureCommand(secure, chosen, "revoke", SecureVerb::Revoke,
                "Have the server refuse a client, a second later at most")
      .name()
      .folder()
      .flag("--former", &SecureOptions::former,
            "Only what it had before secure renew: its newest credentials stay good")
      .example("kinshipd secure revoke arm_7 --security DIR");
  SecureCommand(secure, chosen, "list", SecureVerb::List, "Who has credentials, and until when")
      .folder()
      .flag("--json", &SecureOptions::json, "One document on stdout")
      .example("kinshipd secure list --security DIR");
}

/// Verbs about the server and the authority.
void add_authority_verbs(CLI::App& secure, std::optional<SecureOptions>& chosen) {
  SecureCommand(secure, chosen, "renew-server", SecureVerb::RenewServer,
                "New credentials for the server, from its next start on")
      .folder()
      .days(kServerDays)
      .authority_key()
      .example("kinshipd secure renew-server --security DIR");
  SecureCommand(secure, chosen, "renew-authority", SecureVerb::RenewAuthority,
                "A second authority, which issues from now on; both are trusted")
      .folder()
      .days(kServerDays)
      .authority_key()
      .flag("--leaked", &SecureOptions::leaked,
            "Others know the key, or it is lost: the new authority alone is trusted; clients are "
            "shut out until they have new credentials")
      .example(
          "kinshipd secure renew-authority --security DIR     then: restart the server,\n"
          "  renew each client, retire-authority, restart the server, renew each client again");
  SecureCommand(secure, chosen, "retire-authority", SecureVerb::RetireAuthority,
                "Trust the newer authority only, once every client has its credentials")
      .folder()
      .days(kServerDays)
      .authority_key()
      .flag("--force", &SecureOptions::force, "Also if clients are shut out by it")
      .example("kinshipd secure retire-authority --security DIR");
}

}  // namespace

void add_secure_verbs(CLI::App& app, std::optional<SecureOptions>& options) {
  CLI::App* const secure =
      app.add_subcommand("secure", "Authority, certificates and permissions of the fleet")
          ->configurable(false)
          ->require_subcommand(1);
  secure->footer(kSecureFooter);
  SecureCommand(*secure, options, "init", SecureVerb::Init,
                "Make a security folder: authority and the server's credentials")
      .new_folder()
      .days(kServerDays)
      .example("kinshipd secure init /var/lib/kinship/security");
  add_client_verbs(*secure, options);
  add_authority_verbs(*secure, options);
}

}  // namespace kinship::app
