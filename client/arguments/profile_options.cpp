#include "client/arguments/profile_options.hpp"

#include <CLI/CLI.hpp>

namespace kinship::arguments {

std::vector<CLI::Option*> add_profile_options(CLI::App& app, std::string& profile) {
  CLI::Option* const named =
      app.add_option("--profile", profile,
                     "profile of the distribution: default or paper, and what is to be different")
          ->capture_default_str();
  // CLI11 reads options in the order they were added: this one finds the profile complete.
  CLI::Option* const estimator =
      app.add_option_function<std::string>(
             "--estimator",
             [&profile](const std::string& word) { profile += ",estimator=" + word; },
             "gmm: a Gaussian mixture; kde: a kernel density estimate (default: the profile's)")
          ->check(CLI::IsMember({"gmm", "kde"}));
  return {named, estimator};
}

}  // namespace kinship::arguments
