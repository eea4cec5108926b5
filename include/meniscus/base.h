/// What every stage shares: errors, arrays and images, views, particles, parallel loops, timing.
///
/// Lengths are metres, times are seconds, colours are linear, angles are radians unless a name says
/// otherwise. World space is the space of the particle files; nothing is turned on the way in.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meniscus {

using glm::vec2;
using glm::vec3;

// --- Errors ------------------------------------------------------------------------------------------------

enum class ErrorCode {
  invalid_argument,  ///< the caller passed a value outside its documented range
  not_found,         ///< a file, directory, frame or attribute does not exist
  malformed_file,    ///< a file's bytes contradict its format
  unsupported,       ///< a known format's feature that is not implemented
  io_failed,         ///< the operating system refused to read or write
  limit_exceeded,    ///< what a file or an option asks for is more than it can justify
};

/// What went wrong, in parts; only `problem` is required.
struct ErrorDetail {
  std::string problem;                       ///< one clause: "the file ends inside its point list"
  std::string expected;                      ///< "12,000 bytes of positions"
  std::string found;                         ///< "7,312 bytes"
  std::string path;                          ///< file that the error is about
  std::optional<std::uint64_t> byte_offset;  ///< where in the file, bytes from its start (after decompression)
  std::optional<std::uint64_t> line;         ///< where in a text file, from 1
  std::string advice;                        ///< what to do: "write the frame again"
};

/// The one exception type of the library. what() joins the parts into one line:
/// "path:line: problem (expected ..., found ..., at byte N); advice".
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, ErrorDetail detail);
  Error(ErrorCode code, std::string problem) : Error(code, ErrorDetail{std::move(problem), {}, {}, {}, {}, {}, {}}) {}
  ErrorCode code() const noexcept { return code_; }
  const ErrorDetail& detail() const noexcept { return detail_; }

 private:
  ErrorCode code_;
  ErrorDetail detail_;
};

// --- Images ------------------------------------------------------------------------------------------------

/// A row-major array of width x height values; row 0 is the top of the picture.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width),
        height_(height),
        pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}
  int width() const { return width_; }
  int height() const { return height_; }
  bool empty() const { return pixels_.empty(); }
  std::size_t size() const { return pixels_.size(); }
  T* data() { return pixels_.data(); }
  const T* data() const { return pixels_.data(); }
  T* row(int y) { return pixels_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_); }
  const T* row(int y) const { return pixels_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_); }
  T& operator()(int x, int y) { return row(y)[x]; }
  const T& operator()(int x, int y) const { return row(y)[x]; }
  T& operator[](std::size_t i) { return pixels_[i]; }
  const T& operator[](std::size_t i) const { return pixels_[i]; }
  auto begin() { return pixels_.begin(); }
  auto end() { return pixels_.end(); }
  auto begin() const { return pixels_.begin(); }
  auto end() const { return pixels_.end(); }

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T> pixels_;
};

// --- Space -------------------------------------------------------------------------------------------------

enum class Axis { x, y, z };

/// Unit vector of an axis.
vec3 direction_of(Axis axis);
/// "x", "y" or "z".
std::string_view name_of(Axis axis);

/// An axis-aligned box; empty until a point is added.
struct Bounds {
  vec3 low{std::numeric_limits<float>::infinity()};
  vec3 high{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(low.x <= high.x && low.y <= high.y && low.z <= high.z); }
  void add(vec3 point);
  void add(const Bounds& other);
  /// Zero for an empty box.
  vec3 centre() const;
  vec3 extent() const;
  /// The box grown by `margin` on every side; an empty box stays empty.
  Bounds grown(float margin) const;
};

// --- Views -------------------------------------------------------------------------------------------------

enum class Projection { perspective, orthographic, cube };

/// One ray: `direction` is a unit vector.
struct Ray {
  vec3 origin;
  vec3 direction;
};

/// What the world is seen through: an eye with a picture plane, a plane alone, or a cube around the eye.
///
/// A cube view shows six square faces side by side, width = 6 height: +right, -right, +up, -up, +forward, -forward;
/// each is the perspective view of face().
///
/// Picture coordinates are pixels, (0, 0) at the top left corner of the picture, so that the centre of the
/// first pixel is (0.5, 0.5). right, up and forward are orthonormal, world space.
struct View {
  Projection projection = Projection::perspective;
  int width = 0;   ///< px
  int height = 0;  ///< px
  vec3 eye{0.0f};  ///< perspective: the eye. orthographic: the centre of the plane where rays start
  vec3 right{1, 0, 0};
  vec3 up{0, 1, 0};
  vec3 forward{0, 0, -1};
  /// Half of the picture's height: perspective: at distance 1 along forward (the tangent of half the vertical
  /// field of view); orthographic: in metres; cube: 1.
  float half_height = 0.5f;

  /// The ray through a point of the picture.
  Ray ray(vec2 picture_point) const;
  /// Where a world point lies in the picture: x, y in px and the depth along forward (of the face, in a cube view)
  /// in m. The x and y of a point behind a perspective eye are meaningless; test z > 0.
  vec3 project(vec3 point) const;
  /// Cube views: the perspective view of one of the six faces, 0 .. 5, height x height px.
  View face(int index) const;
  /// Size in the world of one pixel at `depth` m along forward.
  float pixel_size(float depth) const;
  /// The same picture at another resolution of the same aspect ratio.
  View resized(int new_width, int new_height) const;
};

/// Perspective view from `eye` towards `target`.
/// @param up_hint   any vector not parallel to the viewing direction; another axis is taken when it is
/// @param vertical_fov  full vertical field of view, radians, in (0, pi)
/// @throws Error    invalid_argument: eye == target, sizes < 1, field of view out of range
View perspective_view(vec3 eye, vec3 target, vec3 up_hint, float vertical_fov, int width, int height);

/// Orthographic view from a plane through `eye` towards `target`; the picture is `world_height` m high.
View orthographic_view(vec3 eye, vec3 target, vec3 up_hint, float world_height, int width, int height);

/// Cube view from `eye`; `size` px is the edge of a face. Axes are those of the world: right x, up y, forward -z.
/// @throws Error invalid_argument: size < 1
View cube_view(vec3 eye, int size);

// --- Particles ---------------------------------------------------------------------------------------------

/// One per-particle attribute: `components` floats for each particle, interleaved.
struct Attribute {
  std::string name;  ///< as in the file; velocity is called "velocity" whatever the file calls it
  int components = 1;
  std::vector<float> values;
};

/// The particles of one frame: structure of arrays, SI units.
struct Particles {
  std::vector<float> x, y, z;          ///< m, from `origin`; all finite
  std::vector<Attribute> attributes;   ///< each as long as x times its components
  std::optional<double> time;          ///< s, if the file tells
  std::optional<Axis> up;              ///< if the file tells
  std::optional<float> spacing;        ///< m, if the file tells
  glm::dvec3 origin{0.0};              ///< m, in the file's own coordinates; not zero only far from their origin
  std::string format;                  ///< "bgeo", "xyz", "vtk", "ply", "hdf5" ...: as docs/formats.md lists them
  std::size_t dropped_non_finite = 0;  ///< particles that the reader left out: NaN or infinite positions
  std::vector<std::string> notes;      ///< what a user should be told about the reading

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  /// The attribute of that name, or null.
  const Attribute* find(std::string_view name) const;
  Bounds bounds() const;
};

// --- Running -----------------------------------------------------------------------------------------------

/// A view of a callable, not owning: cheap to pass, valid during the call only.
template <class Signature>
class FunctionRef;
template <class R, class... A>
class FunctionRef<R(A...)> {
 public:
  template <class F>
  FunctionRef(F&& f)  // NOLINT: implicit by intention
      : object_(const_cast<void*>(static_cast<const void*>(&f))),
        call_([](void* object, A... a) -> R { return (*static_cast<std::remove_reference_t<F>*>(object))(a...); }) {}
  R operator()(A... a) const { return call_(object_, a...); }

 private:
  void* object_;
  R (*call_)(void*, A...);
};

/// Calls body(begin, end) on pieces of [0, count) of at most `grain`, on all threads. The pieces are the same
/// for any number of threads; a body must write only what belongs to its piece. Exceptions reach the caller.
void parallel_for(std::size_t count, std::size_t grain, FunctionRef<void(std::size_t, std::size_t)> body);

/// Limits parallel_for to `count` threads while it lives; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* control_;
};

/// Threads that parallel_for would use now.
int thread_count();

/// Makes SIGINT, SIGTERM and SIGHUP remove the temporary files that are open and then end the process as they do by
/// default. For programs; the library alone leaves signals as they are.
void remove_temporary_files_when_stopped();

/// Milliseconds by stage, in the order of first use; times of the same name add up.
class StageTimes {
 public:
  void add(std::string_view stage, double ms);
  void add(const StageTimes& other);
  double total_ms() const;
  const std::vector<std::pair<std::string, double>>& rows() const { return rows_; }

 private:
  std::vector<std::pair<std::string, double>> rows_;
};

/// Adds the time from its construction to its end to a row; a null table is allowed and measures nothing.
class StageTimer {
 public:
  StageTimer(StageTimes* times, std::string_view stage);
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimes* times_;
  std::string stage_;
  std::int64_t start_ns_;
};

/// Largest resident set of this process so far, bytes.
std::uint64_t peak_rss_bytes();

}  // namespace meniscus
