/// The arrays of a legacy VTK file, ASCII or binary.
#pragma once

#include "io/positions.h"
#include "io/text.h"

namespace meniscus::io {

/// How one VTK type name is stored.
struct VtkType {
  enum class Kind { number, bit, text, variant };
  Kind kind = Kind::number;
  Scalar scalar = Scalar::float32;
};

/// Reads arrays where a TextCursor stands and moves it past them.
class VtkArrays {
 public:
  VtkArrays(const Source& source, TextCursor& text, bool binary) : source_(source), text_(text), binary_(binary) {}

  bool binary() const { return binary_; }

  /// The type of that name. Throws malformed_file for an unknown one.
  VtkType type_of(std::string_view name) const;

  /// Binary values begin on the line after their keyword: moves there.
  void begin();

  /// Reads tuples * components values. Text and bits give an empty vector; they are moved over.
  /// @throws Error malformed_file: fewer bytes than the count takes; nothing is allocated then
  std::vector<float> read(VtkType type, std::uint64_t tuples, std::uint64_t components, std::string_view what);
  /// Reads three-component tuples into the positions.
  void read_points(VtkType type, std::uint64_t count, const ReadOptions& options, Particles& particles);
  /// Moves over an array.
  void skip(VtkType type, std::uint64_t tuples, std::uint64_t components, std::string_view what);

 private:
  std::uint64_t checked_size(VtkType type, std::uint64_t tuples, std::uint64_t components, std::string_view what) const;
  template <class T>
  void read_text(std::span<T> values, std::string_view what);
  void skip_texts(VtkType type, std::uint64_t values, std::string_view what);
  const Source& source_;
  TextCursor& text_;
  bool binary_;
};

/// A name as written in the file: %20 and the like are resolved.
std::string vtk_name(std::string_view word);

}  // namespace meniscus::io
