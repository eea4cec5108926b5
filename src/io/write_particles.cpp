#include <fmt/format.h>

#include "io/formats.h"
#include "io/text.h"

namespace meniscus {

void write_particles(const std::string& path, const Particles& particles) {
  const std::string name = io::lower(path);
  std::string endings;
  for (const io::Writer& writer : io::writers()) {
    if (name.ends_with(writer.ending)) {
      writer.write(path, particles);
      return;
    }
    endings += fmt::format("{}{}", endings.empty() ? "" : ", ", writer.ending);
  }
  throw Error(ErrorCode::invalid_argument,
              {"the ending of the name is no format that particles are written in", endings, {}, path, {}, {}, {}});
}

}  // namespace meniscus
