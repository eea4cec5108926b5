#include "render/scene_file_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/nearest_name.h"

namespace meniscus::scene_file {
namespace {

void refuse_kind(const JsonValue& value, const Field& field) {
  std::vector<std::string> words;
  for (const Form& form : field.forms) words.push_back(form.words());
  value.refuse("is of the wrong kind", fmt::format("{}", fmt::join(words, ", or ")), value.dump());
}

void check_number(const JsonValue& value, const Form& form) {
  if (!value.is_number()) value.refuse("is of the wrong kind", "a number", value.dump());
  if (form.whole && !value.is_integer()) value.refuse("is no whole number", form.words(), value.dump());
  // What is beyond the largest float is no length, angle or colour.
  const double number = value.number();
  if (!form.range.holds(number) || !(std::abs(number) <= std::numeric_limits<float>::max()))
    value.refuse("is out of range", form.range.words().empty() ? form.words() : form.range.words(), value.dump());
}

void check_numbers(const JsonValue& value, const Form& form) {
  if (value.size() < form.least || value.size() > form.most)
    value.refuse("has not the right length", form.words(), fmt::format("{} numbers", value.size()));
  for (std::size_t i = 0; i < value.size(); ++i) check_number(value.at(i), form);
}

void read_value(const JsonValue& value, const Form& form, const Field& field, Draft& draft) {
  switch (form.kind) {
    case Kind::integer:
    case Kind::number:
      check_number(value, form);
      break;
    case Kind::numbers:
      check_numbers(value, form);
      break;
    case Kind::rows:
      if (value.size() < form.least || value.size() > form.most)
        value.refuse("has not the right length", form.words(), fmt::format("{} rows", value.size()));
      for (std::size_t i = 0; i < value.size(); ++i) {
        if (!value.at(i).is_list())
          value.at(i).refuse("is of the wrong kind", fmt::format("a list of {} numbers", form.columns),
                             value.at(i).dump());
        check_numbers(value.at(i), numbers(form.columns, form.range));
      }
      break;
    case Kind::boxes:
      for (std::size_t i = 0; i < value.size(); ++i) {
        const JsonValue box = value.at(i);
        if (!box.is_list() || box.size() != 2 || !box.at(0).is_list() || !box.at(1).is_list())
          box.refuse("is no box", "two opposite corners, [[x, y, z], [x, y, z]]", box.dump());
        for (std::size_t corner = 0; corner < 2; ++corner) check_numbers(box.at(corner), numbers(3));
      }
      break;
    case Kind::name:
      if (std::find(form.names.begin(), form.names.end(), value.text()) == form.names.end()) {
        const std::string nearest = nearest_name(value.text(), form.names);
        value.refuse("is not known", form.words(), value.dump(),
                     nearest.empty() ? "" : "did you mean " + nearest + "?");
      }
      break;
    case Kind::file:
      check_file(value, draft);
      break;
    case Kind::texts:
      if (value.size() == 0) value.refuse("is empty", form.words(), value.dump());
      for (std::size_t i = 0; i < value.size(); ++i)
        if (!value.at(i).is_text()) value.at(i).refuse("is of the wrong kind", "a text", value.at(i).dump());
      break;
    default:
      break;
  }
  if (field.store) field.store(value, draft);
  if (form.kind == Kind::object) read_section(value, *form.section, draft);
  if (form.kind == Kind::objects)
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (!value.at(i).is_object()) value.at(i).refuse("is of the wrong kind", "an object", value.at(i).dump());
      read_section(value.at(i), *form.section, draft);
    }
}

/// What to say of an unknown name: the nearest one here, or where else it is known.
std::string advice_on(const std::string& name, const Section& section) {
  std::vector<std::string> known;
  for (const Field& field : section.fields) known.push_back(field.name);
  const std::string nearest = nearest_name(name, known);
  if (!nearest.empty()) return "did you mean " + nearest + "?";
  std::vector<std::string> elsewhere;
  for (const Section* other : all_sections())
    for (const Field& field : other->fields)
      if (field.name == name) elsewhere.push_back(other->title.empty() ? name : other->title + "." + name);
  if (!elsewhere.empty()) return fmt::format("there is {}", fmt::join(elsewhere, ", "));
  return fmt::format("known here: {}", fmt::join(known, ", "));
}

}  // namespace

std::string Draft::resolved(const std::string& path) const {
  return path.empty() || path.front() == '/' ? path : folder + path;
}

bool Range::holds(double value) const {
  return (above_low ? value > low : value >= low) && (below_high ? value < high : value <= high);
}

std::string Range::words() const {
  const bool has_low = std::isfinite(low), has_high = std::isfinite(high);
  if (has_low && has_high)
    return fmt::format("{}{:g} to {}{:g}", above_low ? "above " : "", low, below_high ? "below " : "", high);
  if (has_low) return above_low ? fmt::format("above {:g}", low) : fmt::format("{:g} or more", low);
  if (has_high) return below_high ? fmt::format("below {:g}", high) : fmt::format("{:g} or less", high);
  return {};
}

bool Form::fits(const JsonValue& value) const {
  switch (kind) {
    case Kind::boolean:
      return value.is_boolean();
    case Kind::integer:
    case Kind::number:
      return value.is_number();
    case Kind::text:
    case Kind::name:
    case Kind::file:
    case Kind::path:
      return value.is_text();
    case Kind::object:
      return value.is_object();
    case Kind::objects:
    case Kind::texts:
    case Kind::rows:
    case Kind::boxes:
    case Kind::numbers:
      return value.is_list();
  }
  return false;
}

std::string Form::words() const {
  const std::string limits = range.words().empty() ? "" : ", " + range.words();
  switch (kind) {
    case Kind::boolean:
      return "true or false";
    case Kind::integer:
      return "a whole number" + limits;
    case Kind::number:
      return "a number" + limits;
    case Kind::numbers:
      return fmt::format("a list of {}{} {}numbers{}", least, least == most ? "" : fmt::format(" to {}", most),
                         whole ? "whole " : "", limits);
    case Kind::text:
      return "a text";
    case Kind::name:
      return fmt::format("{}", fmt::join(names, ", "));
    case Kind::file:
      return "the path of a file";
    case Kind::path:
      return "a path";
    case Kind::object:
      return "an object";
    case Kind::objects:
      return "a list of objects";
    case Kind::texts:
      return "a list of texts";
    case Kind::boxes:
      return "a list of boxes, each of two corners of 3 numbers";
    case Kind::rows:
      return fmt::format("a list of {} lists of {} numbers",
                         least == most ? fmt::to_string(least) : fmt::format("{} to {}", least, most), columns);
  }
  return {};
}

Form a_boolean() { return {Kind::boolean}; }
Form an_integer(double low, double high) { return {Kind::integer, between(low, high), 0, 0, 0, {}, nullptr, true}; }
Form a_number(Range range) { return {Kind::number, range}; }
Form numbers(std::size_t count, Range range) { return {Kind::numbers, range, count, count}; }
Form whole_numbers(std::size_t count, Range range) {
  return {Kind::numbers, range, count, count, 0, {}, nullptr, true};
}
Form a_name(std::vector<std::string> names) { return {Kind::name, {}, 0, 0, 0, std::move(names)}; }
Form an_object(const Section& section) { return {Kind::object, {}, 0, 0, 0, {}, &section}; }
Form objects(const Section& section) { return {Kind::objects, {}, 0, 0, 0, {}, &section}; }

Range above(double low) { return {low, std::numeric_limits<double>::infinity(), true}; }
Range at_least(double low) { return {low}; }
Range between(double low, double high) { return {low, high}; }

void check_file(const JsonValue& value, const Draft& draft) {
  const std::string path = draft.resolved(value.text());
  std::error_code ignored;
  if (std::filesystem::is_regular_file(path, ignored)) return;
  const TextPosition position = value.position();
  throw Error(ErrorCode::not_found,
              {fmt::format("{} names a file that is not there, at column {}", value.field(), position.column),
               {},
               path,
               value.file().path(),
               {},
               position.line,
               "paths are relative to the folder of this file"});
}

void read_section(const JsonValue& value, const Section& section, Draft& draft) {
  if (section.begin) section.begin(draft);
  for (const std::string& key : value.keys()) {
    const auto field =
        std::find_if(section.fields.begin(), section.fields.end(), [&](const Field& f) { return f.name == key; });
    if (field == section.fields.end()) value.refuse_key(key, "is no field of a scene", advice_on(key, section));
  }
  // In the order of the table, whatever the order of the file.
  for (const Field& field : section.fields) {
    if (!value.has(field.name)) continue;
    const JsonValue member = value.member(field.name);
    const auto form =
        std::find_if(field.forms.begin(), field.forms.end(), [&](const Form& f) { return f.fits(member); });
    if (form == field.forms.end()) refuse_kind(member, field);
    read_value(member, *form, field, draft);
  }
  if (section.finish) section.finish(value, draft);
}

}  // namespace meniscus::scene_file
