#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "render/scene_file_fields.h"

namespace meniscus {
namespace {

const std::string kDocs = std::string(MENISCUS_SOURCE_DIR) + "/docs/";
const std::string kBegin = "<!-- fields: made from the program's own table -->\n";

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// With MENISCUS_UPDATE_DOCS set the documents are written instead.
bool updates() { return std::getenv("MENISCUS_UPDATE_DOCS") != nullptr; }

TEST(SceneFileDocument, HasTheTablesOfAllFields) {
  const std::string document = text_of(kDocs + "scene_file.md");
  const std::size_t begin = document.find(kBegin);
  ASSERT_NE(begin, std::string::npos);
  const std::string current = document.substr(0, begin) + kBegin + "\n" + scene_file::field_tables();
  if (updates()) std::ofstream(kDocs + "scene_file.md", std::ios::binary) << current;
  EXPECT_EQ(text_of(kDocs + "scene_file.md"), current) << "write it again: MENISCUS_UPDATE_DOCS=1 test_render";
}

TEST(SceneFileSchema, IsTheOneInTheDocuments) {
  if (updates()) std::ofstream(kDocs + "scene.schema.json", std::ios::binary) << scene_file_schema();
  EXPECT_EQ(text_of(kDocs + "scene.schema.json"), scene_file_schema())
      << "write it again: MENISCUS_UPDATE_DOCS=1 test_render";
}

TEST(SceneFileSchema, DefinesWhatItRefersTo) {
  const nlohmann::json schema = nlohmann::json::parse(scene_file_schema());
  std::size_t references = 0;
  const nlohmann::json flat = schema.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (pointer.size() < 5 || pointer.substr(pointer.size() - 5) != "/$ref") continue;
    const std::string target = value.get<std::string>().substr(1);
    EXPECT_TRUE(schema.contains(nlohmann::json::json_pointer(target))) << target;
    ++references;
  }
  EXPECT_GT(references, 15u);
}

TEST(SceneFileTable, HasEachFieldOnceWithADefaultAndHelp) {
  for (const scene_file::Section* section : scene_file::all_sections()) {
    std::vector<std::string> names;
    for (const scene_file::Field& field : section->fields) {
      EXPECT_EQ(std::count(names.begin(), names.end(), field.name), 0) << section->title << "." << field.name;
      names.push_back(field.name);
      EXPECT_FALSE(field.help.empty()) << section->title << "." << field.name;
      EXPECT_FALSE(field.forms.empty()) << section->title << "." << field.name;
      ASSERT_FALSE(field.standard.empty()) << section->title << "." << field.name;
      if (field.standard.front() == '(') {
        EXPECT_EQ(field.standard.back(), ')');
      } else {
        EXPECT_TRUE(nlohmann::json::accept(field.standard)) << field.standard;
      }
    }
  }
}

}  // namespace
}  // namespace meniscus
