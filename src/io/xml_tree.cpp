#include "io/xml_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <pugixml.hpp>

namespace meniscus::io {
namespace {

constexpr int kDeepest = 16;                   ///< VTK's own files have 7 levels
constexpr std::ptrdiff_t kMostTags = 400'000;  ///< start and end tags; a node takes 64 bytes, a tag 3
constexpr std::ptrdiff_t kMostValues = 2'000'000;

/// Where the text before the first child stands: from where it was found to the next tag.
void find_text(const Source& source, std::size_t size, const pugi::xml_node& node, XmlElement& element) {
  const pugi::xml_node first = node.first_child();
  if (first.type() != pugi::node_pcdata || first.offset_debug() < 0) return;
  element.text_begin = std::min(size, static_cast<std::size_t>(first.offset_debug()));
  const char* begin = source.bytes.data() + element.text_begin;
  const void* end = std::memchr(begin, '<', size - element.text_begin);
  element.text_end =
      end != nullptr ? element.text_begin + static_cast<std::size_t>(static_cast<const char*>(end) - begin) : size;
}

XmlElement element_of(const Source& source, std::size_t size, const pugi::xml_node& node, int depth) {
  XmlElement element;
  element.name = node.name();
  element.at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug()));
  if (depth > kDeepest) source.malformed("the XML is nested too deep", element.at, fmt::format("{} levels", kDeepest));
  for (const pugi::xml_attribute& attribute : node.attributes())
    element.attributes.emplace_back(attribute.name(), attribute.value());
  find_text(source, size, node, element);
  for (const pugi::xml_node& child : node.children())
    if (child.type() == pugi::node_element) element.children.push_back(element_of(source, size, child, depth + 1));
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

  // The parser writes into what it reads: it gets a copy, whose offsets are those of the file.
  Bytes copy(xml.size() + closing.size());
  std::copy(xml.begin(), xml.end(), copy.data());
  std::copy(closing.begin(), closing.end(), copy.data() + xml.size());
  pugi::xml_document document;
  const pugi::xml_parse_result result =
      document.load_buffer_inplace(copy.data(), copy.size(), pugi::parse_escapes, pugi::encoding_utf8);
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  if (!result) {
    const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, result.offset));
    source.malformed(at >= xml.size() ? "the file ends inside its XML" : "the XML is damaged", std::min(at, xml.size()),
                     {}, result.description());
  }
  const pugi::xml_node root = document.document_element();
  if (!root) source.malformed("the XML has no element", 0);
  return element_of(source, xml.size(), root, 1);
}

}  // namespace meniscus::io
