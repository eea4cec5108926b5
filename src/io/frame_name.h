/// Names of frame files: their kind, their digits, their natural order.
#pragma once

#include "meniscus/base.h"

namespace meniscus::io {

/// Natural order: runs of digits compare as numbers, so that frame_9 comes before frame_10.
bool natural_less(std::string_view a, std::string_view b);

/// A file name without directories, taken apart: text, digits, text, digits, ..., text, extension.
struct FrameName {
  std::vector<std::string> texts;   ///< one more than digits; may be empty
  std::vector<std::string> digits;  ///< runs of digits before the extension
  std::string extension;            ///< ".bgeo", ".vtk.gz"; lower case

  explicit FrameName(std::string_view name);
  /// The run of digits that looks most like a frame number: the last that is no part of a decimal number and is
  /// not followed by a letter, as in "3d".
  std::optional<std::size_t> likely_number() const;
  /// The name with {} for one run of digits.
  std::string with_braces(std::optional<std::size_t> run) const;
};

/// Digits as a number; none beyond 18 digits.
std::optional<std::int64_t> number_of(const std::string& digits);

/// How readily an extension is taken for particles, 0 first; none for kinds that are not read.
std::optional<int> rank_of_extension(std::string_view extension);
/// Whether files of this extension may be any text, so that their content must be looked at.
bool is_any_text(std::string_view extension);
/// The same of files that are no text: programs of all kinds write .bin, and .pdb are proteins more often than not.
bool is_any_binary(std::string_view extension);

/// The directory of a path with its last '/', or "".
std::string directory_of(const std::string& path);
/// What follows the last '/'.
std::string name_in(const std::string& path);

}  // namespace meniscus::io
