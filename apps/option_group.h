/// Adding options to a command in groups.
#pragma once

#include <fmt/format.h>

#include "parse.h"
#include "picture_options.h"

namespace meniscus::apps {

/// Adds options of one group. Each hands its value to a function that sets it in PictureOptions: at once, so that
/// wrong values show while the arguments are parsed, and again over what a scene file says.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, const char* name, std::vector<PictureSetter>& setters)
      : command_(command), name_(name), setters_(setters) {}
  template <class Take>
  CLI::Option* text(const char* option, const char* type, Take take, const std::string& description) {
    return number<std::string>(option, type, take, description);
  }
  template <class Value, class Take>
  CLI::Option* number(const char* option, const char* type, Take take, const std::string& description) {
    const auto given = [&setters = setters_, take](const Value& value) {
      PictureOptions trial;
      take(trial, value);
      setters.push_back([take, value](PictureOptions& options) { take(options, value); });
    };
    return command_.add_option_function<Value>(option, given, description)->type_name(type)->group(name_);
  }
  /// An option that may be repeated, one value each time.
  template <class Take>
  void list(const char* option, const char* type, Take take, const std::string& description) {
    number<std::vector<std::string>>(
        option, type,
        [take](PictureOptions& options, const std::vector<std::string>& values) {
          for (const std::string& value : values) take(options, value);
        },
        description)
        ->allow_extra_args(false);
  }
  template <class Take>
  void flag(const char* option, Take take, const std::string& description) {
    command_
        .add_flag_callback(
            option, [&setters = setters_, take] { setters.emplace_back(take); }, description)
        ->group(name_);
  }

 private:
  CLI::App& command_;
  const char* name_;
  std::vector<PictureSetter>& setters_;
};

/// The value, if it is in [low, high]. @throws UsageError
template <class Number>
Number in_range(const char* option, Number value, Number low, Number high) {
  if (!(value >= low && value <= high))
    throw UsageError(fmt::format("{}: {} to {} was expected, not {}", option, low, high, value));
  return value;
}

}  // namespace meniscus::apps
