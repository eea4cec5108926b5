// Calls a few functions of the installed library; the exit code is the number of claims that do not hold.
#include <cmath>
#include <cstdio>

#include "all_headers.h"

namespace {

int failures = 0;

void claim(bool holds, const char* what) {
  if (holds) return;
  std::printf("does not hold: %s\n", what);
  ++failures;
}

}  // namespace

int main() {
  using namespace meniscus;
  const View view = perspective_view({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 1.0f, 64, 48);
  const vec3 centre = view.project({0, 0, 0});
  claim(std::abs(centre.x - 32.0f) < 1e-3f && std::abs(centre.y - 24.0f) < 1e-3f && std::abs(centre.z - 5.0f) < 1e-5f,
        "what is looked at lies in the middle of the picture");

  Bounds bounds;
  claim(bounds.empty(), "new bounds are empty");
  bounds.add(vec3{-1, 0, 2});
  bounds.add(vec3{3, 4, 0});
  claim(bounds.extent() == vec3{4, 4, 2}, "bounds span what was added");

  Image<float> squares(100, 1);
  parallel_for(squares.size(), 7, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) squares[i] = static_cast<float>(i * i);
  });
  claim(squares[0] == 0.0f && squares[99] == 9801.0f, "parallel_for reaches both ends");

  bool thrown = false;
  try {
    perspective_view({0, 0, 0}, {0, 0, 0}, {0, 1, 0}, 1.0f, 64, 48);
  } catch (const Error& error) {
    thrown = error.code() == ErrorCode::invalid_argument;
  }
  claim(thrown, "errors cross the library's boundary");

  Particles ball;
  for (int z = -4; z <= 4; ++z)
    for (int y = -4; y <= 4; ++y)
      for (int x = -4; x <= 4; ++x)
        if (x * x + y * y + z * z <= 16) {
          ball.x.push_back(0.1f * static_cast<float>(x));
          ball.y.push_back(0.1f * static_cast<float>(y));
          ball.z.push_back(0.1f * static_cast<float>(z));
        }
  PictureOptions options;
  options.width = 64;
  options.height = 48;
  const FramePicture frame = render_frame(ball, settings_of(survey_particles(ball), options));
  claim(frame.picture.width() == 64 && frame.picture.height() == 48, "a frame is drawn at the size asked for");
  claim(frame.buffers.coverage(32, 24) == 1.0f, "the water is in the middle of the picture");
  return failures;
}
