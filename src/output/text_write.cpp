#include "meniscus/output.h"
#include "base/temporary_file.h"

namespace meniscus {

void write_text(const std::string& path, std::string_view text) {
  TemporaryStream stream(path);
  stream.write({text.data(), text.size()});
  stream.commit();
}

}  // namespace meniscus
