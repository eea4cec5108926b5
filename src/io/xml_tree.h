/// A small XML document as a tree: elements, their attributes and where their text stands in the file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "io/bytes.h"

namespace meniscus::io {

struct XmlElement {
  std::string name;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;
  std::size_t at = 0;          ///< byte offset of the name
  std::size_t text_begin = 0;  ///< byte offsets of the text before the first child; equal where there is none
  std::size_t text_end = 0;

  /// The value of an attribute, or null.
  const std::string* find(std::string_view attribute) const;
  /// The value of an attribute, or the other value.
  std::string value(std::string_view attribute, std::string_view otherwise = {}) const;
  /// The first child of that name, or null.
  const XmlElement* child(std::string_view child_name) const;
};

/// The root element of XML in UTF-8 that stands in the first `size` bytes of a source. `closing` is put behind them
/// (end tags of what was cut off). Memory is bounded by the number of tags, which is bounded.
/// @throws Error  malformed_file: no XML, nested too deep, far more tags than a frame needs
XmlElement parse_xml(const Source& source, std::size_t size, std::string_view closing = {});

}  // namespace meniscus::io
