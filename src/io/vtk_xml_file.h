/// A file of VTK's XML formats: its elements, and the arrays that they describe.
#pragma once

#include "io/values.h"
#include "io/xml_tree.h"

namespace meniscus::io {

/// The XML of a file and how its arrays are written. What <AppendedData> holds is no XML and is not parsed.
struct VtkXmlFile {
  Source source;
  XmlElement root;   ///< <VTKFile>
  std::string kind;  ///< its type: "PolyData", "UnstructuredGrid", "PPolyData", "Collection" ...
  std::endian order = std::endian::little;
  Scalar header = Scalar::uint32;  ///< type of the lengths before arrays
  std::string compressor;          ///< "vtkZLibDataCompressor"; empty: none
  std::size_t appended_begin = 0;  ///< byte offsets of the appended data, behind their '_'; equal where there are none
  std::size_t appended_end = 0;
  bool appended_base64 = false;
};

/// Whether the start of a file is XML with VTK's root element.
bool is_vtk_xml(const Source& start);

/// @throws Error  malformed_file, unsupported: XML, but not VTK's
VtkXmlFile open_vtk_xml(const Source& source);

/// The values of one array, which stand in the file or in `owned`.
struct VtkXmlArray {
  Scalar type = Scalar::float32;
  std::endian order = std::endian::native;
  Stored first;
  Bytes owned;
};

/// Gives the values of <DataArray> elements, one after the other.
class VtkXmlArrays {
 public:
  /// @param file  must outlive this
  explicit VtkXmlArrays(const VtkXmlFile& file) : file_(file) {}

  /// The type of an array's values; none for text, bits and whatever else holds no numbers.
  std::optional<Scalar> type_of(const XmlElement& array) const;
  /// tuples * components values.
  /// @throws Error  malformed_file: there are fewer or more, nothing is allocated for a count that the bytes do not
  ///                justify; limit_exceeded: compressed beyond what particles are; unsupported: another compressor
  VtkXmlArray read(const XmlElement& array, std::uint64_t tuples, std::uint64_t components);

 private:
  VtkXmlArray read_text(const XmlElement& array, Scalar type, std::uint64_t values) const;
  class Stream;
  VtkXmlArray read_plain(Stream& stream, std::uint64_t bytes);
  VtkXmlArray read_compressed(Stream& stream, std::uint64_t bytes) const;
  std::uint64_t word(const char* first) const;
  /// Whether an array begins at an offset in the appended data.
  bool begins_at(std::uint64_t offset);
  const VtkXmlFile& file_;
  std::vector<std::uint64_t> offsets_;  ///< of all arrays, in order, once they are asked for
  std::uint64_t made_ = 0;              ///< bytes of binary arrays so far; a piece may be read twice
};

/// An attribute of an element that is a count.
/// @throws Error  malformed_file: it is missing or none
std::uint64_t xml_count(const Source& source, const XmlElement& element, std::string_view attribute);
/// The same; `otherwise` where it is missing.
std::uint64_t xml_count(const Source& source, const XmlElement& element, std::string_view attribute,
                        std::uint64_t otherwise);

}  // namespace meniscus::io
