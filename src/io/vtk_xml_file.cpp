#include "io/vtk_xml_file.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file_bytes.h"
#include "io/text.h"

namespace meniscus::io {
namespace {

constexpr std::string_view kAppended = "<AppendedData";
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

std::string_view text_of(const Source& source) { return {source.bytes.data(), source.bytes.size()}; }

/// What `find` finds in the text of a source, of which it is given the start, ever more of it; npos: nothing in all.
/// @param from  it is found there or behind
template <class Find>
std::size_t find_fetching(const Source& source, std::size_t from, Find find) {
  std::size_t ready = std::max(kBlockBytes, 2 * from);
  while (true) {
    source.need(0, ready);
    const std::size_t found = find(text_of(source).substr(0, ready));
    if (found != std::string_view::npos || ready >= source.bytes.size()) return found;
    ready *= 2;
  }
}

/// Finds what stands between the '_' and the end tag of <AppendedData>. Returns how many bytes before are XML.
std::size_t cut_appended(VtkXmlFile& file, std::size_t tag) {
  const Source& source = file.source;
  const std::string_view text = text_of(source);
  const std::size_t closing = find_fetching(source, tag, [&](std::string_view ready) { return ready.find('>', tag); });
  if (closing == std::string_view::npos) source.malformed("the file ends inside its XML", tag);
  const std::size_t mark = find_fetching(
      source, closing, [&](std::string_view ready) { return ready.find_first_not_of(" \t\r\n", closing + 1); });
  if (mark == std::string_view::npos || text[mark] != '_')
    source.malformed("the appended data do not begin", closing + 1, "'_'",
                     mark == std::string_view::npos ? "the end of the file" : "something else");
  // The end tag is among the last bytes, unless the file is not whole.
  constexpr std::size_t kTail = 1024;
  const std::size_t tail = std::max(mark, text.size() - std::min(text.size(), kTail));
  source.need(tail, kTail);
  const std::size_t last = text.substr(tail).rfind("</AppendedData");
  const std::size_t end = last == std::string_view::npos ? last : tail + last;
  if (end == std::string_view::npos || text.find("</VTKFile", end) == std::string_view::npos)
    source.malformed("the file ends inside its appended data", text.size(), "</AppendedData></VTKFile> at the end");
  file.appended_begin = mark + 1;
  file.appended_end = end;
  return closing + 1;
}

}  // namespace

bool is_vtk_xml(const Source& start) {
  std::string_view text = text_of(start).substr(0, std::size_t{1} << 12);
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<' && text.find("<VTKFile") != std::string_view::npos;
}

VtkXmlFile open_vtk_xml(const Source& source) {
  VtkXmlFile file{source, {}, {}, std::endian::little, Scalar::uint32, {}, 0, 0, false};
  const std::size_t tag = find_fetching(source, 0, [](std::string_view ready) { return ready.find(kAppended); });
  if (tag == std::string_view::npos) {
    file.root = parse_xml(source, source.bytes.size());
  } else {
    const std::size_t size = cut_appended(file, tag);
    file.root = parse_xml(source, size, "</AppendedData></VTKFile>");
    if (const XmlElement* appended = file.root.child("AppendedData"))
      file.appended_base64 = lower(appended->value("encoding", "base64")) != "raw";
    if (file.appended_base64) source.need(file.appended_begin, file.appended_end - file.appended_begin);
  }
  const XmlElement& root = file.root;
  if (root.name != "VTKFile") source.unsupported("is XML, but not of VTK", "export it as .vtu, .vtp or legacy .vtk");
  file.kind = root.value("type");
  if (lower(root.value("byte_order", "LittleEndian")) == "bigendian") file.order = std::endian::big;
  const std::string header = root.value("header_type", "UInt32");
  if (header == "UInt64") {
    file.header = Scalar::uint64;
  } else if (header != "UInt32") {
    source.malformed("the type of the lengths before arrays is unknown", root.at, "UInt32 or UInt64",
                     "'" + header.substr(0, 24) + "'");
  }
  file.compressor = root.value("compressor");
  return file;
}

std::uint64_t xml_count(const Source& source, const XmlElement& element, std::string_view attribute) {
  const std::string* found = element.find(attribute);
  if (found == nullptr)
    source.malformed(fmt::format("<{:.40}> has no {}", element.name, attribute), element.at,
                     fmt::format("{}=\"a count\"", attribute));
  std::string_view digits = *found;
  while (!digits.empty() && is_blank(digits.front())) digits.remove_prefix(1);
  while (!digits.empty() && is_blank(digits.back())) digits.remove_suffix(1);
  std::uint64_t count = 0;
  if (!parse_count(digits, count))
    source.malformed(fmt::format("the {} of <{:.40}> is no count", attribute, element.name), element.at, "a count",
                     "'" + found->substr(0, 24) + "'");
  return count;
}

std::uint64_t xml_count(const Source& source, const XmlElement& element, std::string_view attribute,
                        std::uint64_t otherwise) {
  return element.find(attribute) != nullptr ? xml_count(source, element, attribute) : otherwise;
}

}  // namespace meniscus::io
