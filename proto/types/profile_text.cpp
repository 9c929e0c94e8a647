#include "proto/types/profile_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>

#include "proto/types/number_text.hpp"

namespace kinship {
namespace {

/// A number of a profile that a client may change, and within which limits.
struct Option {
  std::string_view name;
  double least = 0, most = 0;
  bool is_whole = false;
  std::function<void(Profile&, double)> set;
  /// Instead of a number, where an option has them: for 0, for 1, and so on.
  std::vector<std::string_view> words = {};
};

int whole(double value) { return static_cast<int>(std::lround(value)); }

/// In the order of the members.
const std::vector<Option>& options() {
  static const std::vector<Option> kOptions = {
      {"pose_spacing", 0.01, 10, false,
       [](Profile& profile, double value) { profile.transfer.pose_spacing = value; }},
      {"max_poses_per_path", 0, 4096, true,
       [](Profile& profile, double value) { profile.transfer.max_poses_per_path = whole(value); }},
      {"max_solutions", 1, 100, true,
       [](Profile& profile, double value) { profile.transfer.max_solutions = whole(value); }},
      {"min_distance", 0, 10, false,
       [](Profile& profile, double value) { profile.transfer.min_distance = value; }},
      {"dropped_end_share", 0, 0.45, false,
       [](Profile& profile, double value) { profile.transfer.dropped_end_share = value; }},
      {"tracks", 0, 100, true,
       [](Profile& profile, double value) { profile.transfer.tracks = whole(value); }},
      {"least_coverage", 0, 1, false,
       [](Profile& profile, double value) { profile.transfer.least_coverage = value; }},
      {"track_candidates", 1, 100, true,
       [](Profile& profile, double value) { profile.transfer.track_candidates = whole(value); }},
      {"shape_noise", 0, 10, false,
       [](Profile& profile, double value) { profile.transfer.shape_noise = value; }},
      {"shape_steps", 0, 100, true,
       [](Profile& profile, double value) { profile.transfer.shape_steps = whole(value); }},
      {"avoid_self_collision", 0, 1, true,
       [](Profile& profile, double value) { profile.transfer.avoid_self_collision = value != 0; }},
      {"avoid_recorded_scene", 0, 1, true,
       [](Profile& profile, double value) { profile.transfer.avoid_recorded_scene = value != 0; }},
      {"take_over", 0, 1, true,
       [](Profile& profile, double value) { profile.transfer.take_over = value != 0; }},
      {"components", 0, 1000, true,
       [](Profile& profile, double value) { profile.density.components = whole(value); }},
      {"covariance_floor", 1e-8, 1, false,
       [](Profile& profile, double value) { profile.density.covariance_floor = value; }},
      {"covariance_floor_m2", 1e-8, 1, false,
       [](Profile& profile, double value) { profile.density.covariance_floor_m2 = value; }},
      {"equal_path_weights", 0, 1, true,
       [](Profile& profile, double value) { profile.density.equal_path_weights = value != 0; }},
      {"warm_refits", 0, 1, true,
       [](Profile& profile, double value) { profile.density.warm_refits = value != 0; }},
      {"estimator",
       0,
       1,
       true,
       [](Profile& profile, double value) {
         profile.density.estimator = value == 0 ? Estimator::Mixture : Estimator::Kernels;
       },
       {"gmm", "kde"}},
  };
  return kOptions;
}

Error refusal(std::string_view text, const std::string& why) {
  return {ErrorCode::InvalidInput, "profile '" + std::string(text) + "': " + why};
}

/// `auto` is 0, which stands for "choose it" where it is allowed and is no use elsewhere.
std::optional<double> number_of(const Option& option, std::string_view text) {
  if (text == "auto" && option.name == "components")
    return 0;
  if (!option.words.empty()) {
    const auto word = std::find(option.words.begin(), option.words.end(), text);
    return word == option.words.end() ? std::nullopt
                                      : std::optional<double>(word - option.words.begin());
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// "gmm or kde".
std::string listed(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words)
    text += (text.empty() ? "" : " or ") + std::string(word);
  return text;
}

/// Changes what "name=value" says.
/// \return what is wrong with it.
std::optional<std::string> change(Profile& profile, std::string_view word) {
  const std::size_t sign = word.find('=');
  const std::string_view name = word.substr(0, sign);
  for (const Option& option : options()) {
    if (option.name != name)
      continue;
    const auto value =
        sign == std::string_view::npos ? std::nullopt : number_of(option, word.substr(sign + 1));
    const bool fits = value && *value >= option.least && *value <= option.most &&
                      (!option.is_whole || *value == std::round(*value));
    if (!fits && !option.words.empty())
      return "'" + std::string(word) + "' is not " + listed(option.words);
    if (!fits)
      return "'" + std::string(word) + "' is not a" + (option.is_whole ? " whole" : "") +
             " number from " + number_text(option.least) + " to " + number_text(option.most);
    option.set(profile, *value);
    return std::nullopt;
  }
  return "there is no option '" + std::string(name) + "'";
}

}  // namespace

Result<Profile> profile_from_text(std::string_view text) {
  std::size_t comma = text.find(',');
  std::optional<Profile> profile = find_profile(text.substr(0, comma));
  if (!profile)
    return refusal(text, "it does not begin with default or paper");
  while (comma != std::string_view::npos) {
    const std::size_t begin = comma + 1;
    comma = text.find(',', begin);
    if (const auto fault = change(*profile, text.substr(begin, comma - begin)))
      return refusal(text, *fault);
  }
  profile->name = text;
  return *std::move(profile);
}

std::vector<std::string> profile_options() {
  std::vector<std::string> names;
  for (const Option& option : options())
    names.emplace_back(option.name);
  return names;
}

}  // namespace kinship
