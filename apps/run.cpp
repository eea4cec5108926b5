#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <sstream>

#include "commands.h"
#include "meniscus/base.h"
#include "meniscus/output.h"

namespace meniscus::apps {
namespace {

int failed(int code, std::string message) {
  for (char& c : message)
    if (c == '\n') c = ' ';
  std::cout.flush();
  std::cerr << "meniscus: error: " << message << std::endl;
  return code;
}

/// Help with descriptions broken into lines, whatever the width of the terminal, so that documents can hold it.
class Help : public CLI::Formatter {
 public:
  Help() { column_width(kColumn); }
  std::string make_option_desc(const CLI::Option* option) const override {
    std::string wrapped;
    std::size_t length = 0;
    std::istringstream words(CLI::Formatter::make_option_desc(option));
    for (std::string word; words >> word; length += word.size()) {
      const bool fits = length + 1 + word.size() <= kWidth - kColumn;
      if (!wrapped.empty()) wrapped += fits ? ' ' : '\n';
      length = fits ? length + 1 : 0;
      wrapped += word;
    }
    return wrapped;
  }

 private:
  static constexpr std::size_t kColumn = 32, kWidth = 112;
};

/// Which command's help answers an error.
std::string command_path(const CLI::App& program) {
  std::string path = "meniscus";
  const CLI::App* app = &program;
  while (!app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    path += " " + app->get_name();
  }
  return path;
}

}  // namespace

int run(int argc, char** argv) {
  remove_temporary_files_when_stopped();
  CLI::App program("Pictures and films of water from the particles of a simulation", "meniscus");
  program.formatter(std::make_shared<Help>());
  program.set_version_flag("--version", "meniscus " MENISCUS_VERSION, "Print the version and exit");
  program.set_help_flag("-h,--help", "Print this and exit");
  program.require_subcommand(1);
  add_info(program);
  add_render(program);
  add_simulate(program);
  add_bench(program);
  add_compare(program);
  add_convert(program);
  program.footer(
      "Exit codes: 0 done, 1 the run failed, 2 the arguments cannot be meant.\n"
      "Each command has its own --help.");
  const auto usage_failed = [&](const CLI::Error& error) {
    return failed(kWrongUsage, fmt::format("{} (see {} --help)", error.what(), command_path(program)));
  };
  try {
    program.parse(argc, argv);
    std::cout.flush();
    if (!std::cout) return failed(kFailed, "cannot write to the standard output");
    return kSuccess;
  } catch (const CLI::Success& help) {  // --help and --version
    return program.exit(help);
  } catch (const CLI::RuntimeError& end) {
    return end.get_exit_code();
  } catch (const CLI::RequiredError& error) {
    // A command that does not exist says more than that one is missing.
    const std::vector<std::string> unknown = program.remaining(true);
    if (unknown.empty()) return usage_failed(error);
    return failed(kWrongUsage,
                  fmt::format("there is no command {} (see {} --help)", unknown.front(), command_path(program)));
  } catch (const CLI::Error& error) {
    return usage_failed(error);
  } catch (const UsageError& error) {
    return failed(kWrongUsage, error.what());
  } catch (const Error& error) {
    return failed(error.code() == ErrorCode::invalid_argument ? kWrongUsage : kFailed, error.what());
  } catch (const std::bad_alloc&) {
    return failed(kFailed, "there is not enough memory");
  } catch (const std::exception& error) {
    return failed(kFailed, error.what());
  }
}

}  // namespace meniscus::apps
