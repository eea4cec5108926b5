// Whatever the text: a condition that marks each particle, or an Error that says what is wrong with it.
#include <string_view>

#include "checks.h"
#include "io/where.h"

namespace {

using namespace meniscus;

Particles small_frame() {
  Particles particles;
  particles.x = particles.y = particles.z = {0, 1, 2};
  particles.attributes = {{"type", 1, {0, 1, 3}}, {"velocity", 3, std::vector<float>(9, 1)}, {"a b", 1, {1, 2, 3}}};
  return particles;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Particles particles = small_frame();
  try {
    const io::Condition condition({reinterpret_cast<const char*>(data), size});
    std::vector<std::uint8_t> fits(particles.size(), 2);
    condition.judge(particles, fits);
    for (const std::uint8_t fit : fits) require(fit <= 1, "a yes or a no for each particle");
  } catch (const Error& error) {
    require(error.code() == ErrorCode::invalid_argument, "an error about an argument");
  }
  return 0;
}
