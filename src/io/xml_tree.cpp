#include "io/xml_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <pugixml.hpp>

#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr int kDeepest = 16;                   ///< VTK's own files have 7 levels
constexpr std::ptrdiff_t kMostTags = 400'000;  ///< start and end tags; a node takes 64 bytes, a tag 3
constexpr std::ptrdiff_t kMostValues = 2'000'000;
constexpr std::size_t kLongText = 4096;  ///< bytes

/// The XML without the insides of its long texts, which are values of arrays, and where its bytes were.
struct Skeleton {
  Bytes bytes;
  std::size_t size = 0;
  std::vector<std::pair<std::size_t, std::size_t>> places;  ///< from which byte on, and what to add to its offset

  void append(std::span<const char> part) {
    std::copy(part.begin(), part.end(), bytes.data() + size);
    size += part.size();
  }
  /// The offset in the file.
  std::size_t offset(std::ptrdiff_t at) const {
    const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at));
    const auto next = std::upper_bound(places.begin(), places.end(), place,
                                       [](std::size_t value, const auto& entry) { return value < entry.first; });
    return next == places.begin() ? place : place + std::prev(next)->second;
  }
};

/// Where the next `c` is from `at` on, or the end.
std::size_t find_from(std::span<const char> text, char c, std::size_t at) {
  const void* found = at < text.size() ? std::memchr(text.data() + at, c, text.size() - at) : nullptr;
  return found != nullptr ? static_cast<std::size_t>(static_cast<const char*>(found) - text.data()) : text.size();
}

/// @param closing  put behind it
Skeleton skeleton_of(std::span<const char> xml, std::string_view closing) {
  Skeleton skeleton{Bytes(xml.size() + closing.size()), 0, {}};
  // Behind a '>' in a comment or in an attribute's value there is no text: those are kept as they are.
  const bool plain = std::string_view(xml.data(), xml.size()).find("<!") == std::string_view::npos;
  std::size_t at = 0, left_out = 0;
  while (plain && at < xml.size()) {
    const std::size_t text = std::min(xml.size(), find_from(xml, '>', at) + 1);
    const std::size_t end = find_from(xml, '<', text);
    const std::span<const char> inside = xml.subspan(text, end - text);
    const bool whole = inside.size() < kLongText || find_from(inside, '"', 0) < inside.size() ||
                       find_from(inside, '\'', 0) < inside.size();
    const auto first = std::find_if(inside.begin(), inside.end(), [](char c) { return !is_blank(c); });
    const std::size_t kept =
        whole || first == inside.end() ? end : text + static_cast<std::size_t>(first - inside.begin()) + 1;
    skeleton.append(xml.subspan(at, kept - at));
    if (kept < end) skeleton.places.emplace_back(skeleton.size, left_out += end - kept);
    at = end;
  }
  skeleton.append(xml.subspan(at));
  skeleton.append(closing);
  return skeleton;
}

/// Where the text before the first child stands: from where it was found to the next tag.
void find_text(const Source& source, std::size_t size, const Skeleton& skeleton, const pugi::xml_node& node,
               XmlElement& element) {
  const pugi::xml_node first = node.first_child();
  if (first.type() != pugi::node_pcdata || first.offset_debug() < 0) return;
  element.text_begin = std::min(size, skeleton.offset(first.offset_debug()));
  const char* begin = source.bytes.data() + element.text_begin;
  const void* end = std::memchr(begin, '<', size - element.text_begin);
  element.text_end =
      end != nullptr ? element.text_begin + static_cast<std::size_t>(static_cast<const char*>(end) - begin) : size;
}

XmlElement element_of(const Source& source, std::size_t size, const Skeleton& skeleton, const pugi::xml_node& node,
                      int depth) {
  XmlElement element;
  element.name = node.name();
  element.at = skeleton.offset(node.offset_debug());
  if (depth > kDeepest) source.malformed("the XML is nested too deep", element.at, fmt::format("{} levels", kDeepest));
  for (const pugi::xml_attribute& attribute : node.attributes())
    element.attributes.emplace_back(attribute.name(), attribute.value());
  find_text(source, size, skeleton, node, element);
  for (const pugi::xml_node& child : node.children())
    if (child.type() == pugi::node_element)
      element.children.push_back(element_of(source, size, skeleton, child, depth + 1));
  return element;
}

}  // namespace

const std::string* XmlElement::find(std::string_view attribute) const {
  for (const auto& [key, found] : attributes)
    if (key == attribute) return &found;
  return nullptr;
}

std::string XmlElement::value(std::string_view attribute, std::string_view otherwise) const {
  const std::string* found = find(attribute);
  return found != nullptr ? *found : std::string(otherwise);
}

const XmlElement* XmlElement::child(std::string_view child_name) const {
  for (const XmlElement& element : children)
    if (element.name == child_name) return &element;
  return nullptr;
}

XmlElement parse_xml(const Source& source, std::size_t size, std::string_view closing) {
  const std::span<const char> xml = source.bytes.first(std::min(size, source.bytes.size()));
  if (std::count(xml.begin(), xml.end(), '<') > kMostTags || std::count(xml.begin(), xml.end(), '=') > kMostValues)
    source.malformed("has far more XML than a frame needs", 0, fmt::format("at most {} tags", kMostTags));

  // The parser writes into what it reads: it gets a copy.
  Skeleton skeleton = skeleton_of(xml, closing);
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer_inplace(skeleton.bytes.data(), skeleton.size, pugi::parse_escapes, pugi::encoding_utf8);
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  if (!result) {
    const std::size_t at = skeleton.offset(result.offset);
    source.malformed(at >= xml.size() ? "the file ends inside its XML" : "the XML is damaged", std::min(at, xml.size()),
                     {}, result.description());
  }
  const pugi::xml_node root = document.document_element();
  if (!root) source.malformed("the XML has no element", 0);
  return element_of(source, xml.size(), skeleton, root, 1);
}

}  // namespace meniscus::io
