#include "commands.h"
#include "meniscus/base.h"

namespace meniscus::apps {

void add_simulate(CLI::App& program) {
  CLI::App* command = program.add_subcommand("simulate", "Simulate water (not available in this version)");
  command->footer("This version draws what other programs have simulated: see meniscus render --help.");
  command->allow_extras();
  command->callback([] {
    throw Error(ErrorCode::unsupported, {"simulate is not available in this version",
                                         {},
                                         {},
                                         {},
                                         {},
                                         {},
                                         "draw frames of another program with meniscus render"});
  });
}

}  // namespace meniscus::apps
