#include "reading_options.h"

#include <fmt/format.h>

#include "commands.h"
#include "parse.h"

namespace meniscus::apps {
namespace {

std::vector<std::string> parse_names(std::string_view option, std::string_view text) {
  std::vector<std::string> names;
  for (std::size_t comma = 0; comma != std::string_view::npos;) {
    comma = text.find(',');
    names.emplace_back(text.substr(0, comma));
    if (comma != std::string_view::npos) text.remove_prefix(comma + 1);
  }
  if (names.size() != 3)
    throw UsageError(fmt::format("{}: three names separated by commas were expected, as x,y,z", option));
  return names;
}

}  // namespace

void add_reading_options(CLI::App& command, ReadOptions& reading) {
  const char* group = "Files";
  command
      .add_option("--positions", reading.positions,
                  "Array of the positions inside an HDF5 or NPZ file: one of N x 3, such as /PartType0/Coordinates, or "
                  "three separated by commas (default: found by the usual names)")
      ->type_name("PATH")
      ->group(group);
  command
      .add_option_function<std::string>(
          "--columns", [&reading](const std::string& text) { reading.columns = parse_names("--columns", text); },
          "Columns of the positions in text, by name or number from 1 (default: x,y,z by the usual names, or the first "
          "three)")
      ->type_name("X,Y,Z")
      ->group(group);
  command
      .add_option("--raw", reading.raw,
                  "Files are numbers without a header: type (f32, f64, f32be, f64be) and how many a particle, such as "
                  "f32x3; the first three are its position")
      ->type_name("TYPExN")
      ->group(group);
  command
      .add_option("--where", reading.where,
                  "Keep particles whose attributes fit, such as 'type==3' or 'density>=900 && mk!=11' (default: the "
                  "fluid, where a file tells it from boundaries)")
      ->type_name("CONDITION")
      ->group(group);
  command.add_flag("--boundaries", reading.boundaries, "Keep the particles of boundaries, too")->group(group);
  command.add_option("--scale", reading.scale, "Metres that a unit of the files' lengths has (default: 1)")
      ->type_name("METRES")
      ->check(CLI::Range(1e-12, 1e12).description(""))
      ->group(group);
  command
      .add_option_function<std::string>(
          "--origin", [&reading](const std::string& text) { reading.origin = parse_dvec3("--origin", text); },
          "Count positions from this point of the files, m (default: 0,0,0; where doubles lie so far from it that "
          "single precision would lose digits, a round point amidst them)")
      ->type_name("X,Y,Z")
      ->group(group);
  command
      .add_flag("--allow-outside", reading.allow_outside,
                "Files that list others (.pvd, .pvtu, .series) may name some outside of their own directory")
      ->group(group);
}

}  // namespace meniscus::apps
