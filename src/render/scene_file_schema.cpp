/// The table of fields as a JSON Schema and as tables of a document.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "render/scene_file_fields.h"

namespace meniscus {
namespace scene_file {
namespace {

using nlohmann::ordered_json;

void collect(const Section& section, std::vector<const Section*>& sections) {
  if (std::find(sections.begin(), sections.end(), &section) != sections.end()) return;
  sections.push_back(&section);
  for (const Field& field : section.fields)
    for (const Form& form : field.forms)
      if (form.section) collect(*form.section, sections);
}

bool is_json(const std::string& standard) { return !standard.empty() && standard.front() != '('; }

/// A range's end as a whole number where it is one, so that it reads well.
ordered_json number_of(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

ordered_json number_schema(const Form& form) {
  ordered_json schema{{"type", form.whole ? "integer" : "number"}};
  if (std::isfinite(form.range.low))
    schema[form.range.above_low ? "exclusiveMinimum" : "minimum"] = number_of(form.range.low);
  if (std::isfinite(form.range.high))
    schema[form.range.below_high ? "exclusiveMaximum" : "maximum"] = number_of(form.range.high);
  return schema;
}

ordered_json list_schema(ordered_json items, std::size_t least, std::size_t most) {
  ordered_json schema{{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) schema["minItems"] = least;
  if (most > 0) schema["maxItems"] = most;
  return schema;
}

/// "meshes[].rotate" is defined as "meshes.rotate".
std::string definition_of(const Section& section) {
  std::string name;
  for (const char c : section.title)
    if (c != '[' && c != ']') name += c;
  return name;
}

ordered_json reference_to(const Section& section) { return {{"$ref", "#/$defs/" + definition_of(section)}}; }

ordered_json form_schema(const Form& form) {
  switch (form.kind) {
    case Kind::boolean:
      return {{"type", "boolean"}};
    case Kind::integer:
    case Kind::number:
      return number_schema(form);
    case Kind::numbers:
      return list_schema(number_schema(form), form.least, form.most);
    case Kind::text:
    case Kind::file:
    case Kind::path:
      return {{"type", "string"}};
    case Kind::name:
      return {{"enum", form.names}};
    case Kind::object:
      return reference_to(*form.section);
    case Kind::objects:
      return list_schema(reference_to(*form.section), 0, 0);
    case Kind::texts:
      return list_schema({{"type", "string"}}, 1, 0);
    case Kind::boxes:
      return list_schema(list_schema(list_schema({{"type", "number"}}, 3, 3), 2, 2), 0, 0);
    case Kind::rows:
      return list_schema(list_schema(number_schema(form), form.columns, form.columns), form.least, form.most);
  }
  return {};
}

ordered_json section_schema(const Section& section) {
  ordered_json properties = ordered_json::object();
  for (const Field& field : section.fields) {
    ordered_json schema;
    if (field.forms.size() == 1) {
      schema = form_schema(field.forms.front());
    } else {
      for (const Form& form : field.forms) schema["anyOf"].push_back(form_schema(form));
    }
    schema["description"] = field.help + (is_json(field.standard) ? "" : " " + field.standard);
    if (is_json(field.standard)) schema["default"] = ordered_json::parse(field.standard);
    properties[field.name] = std::move(schema);
  }
  return {{"type", "object"},
          {"description", section.help},
          {"properties", std::move(properties)},
          {"additionalProperties", false}};
}

/// A value as a table's cell says it.
std::string cell_of(const Field& field) {
  std::vector<std::string> forms;
  for (const Form& form : field.forms) forms.push_back(form.words());
  return fmt::format("{}", fmt::join(forms, "; or "));
}

std::string standard_of(const Field& field) {
  if (is_json(field.standard)) return "`" + field.standard + "`";
  return field.standard.substr(1, field.standard.size() - 2);
}

}  // namespace

std::vector<const Section*> all_sections() {
  std::vector<const Section*> sections;
  collect(file_section(), sections);
  return sections;
}

std::string field_tables() {
  std::string text;
  for (const Section* section : all_sections()) {
    text += section->title.empty() ? "### The file\n\n" : fmt::format("### `{}`\n\n", section->title);
    text += section->help + "\n\n| field | value | default | meaning |\n| --- | --- | --- | --- |\n";
    for (const Field& field : section->fields)
      text += fmt::format("| `{}` | {} | {} | {} |\n", field.name, cell_of(field), standard_of(field), field.help);
    text += '\n';
  }
  return text;
}

}  // namespace scene_file

std::string scene_file_schema() {
  using namespace scene_file;
  nlohmann::ordered_json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                                {"title", "A scene file of Meniscus"}};
  schema.update(section_schema(file_section()));
  for (const Section* section : all_sections())
    if (!section->title.empty()) schema["$defs"][definition_of(*section)] = section_schema(*section);
  return schema.dump(2) + "\n";
}

}  // namespace meniscus
