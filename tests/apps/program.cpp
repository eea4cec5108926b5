#include "program.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

extern char** environ;

namespace meniscus {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

Outcome run_program(const std::vector<std::string>& arguments) {
  const Folder folder;
  const std::string out = folder / "out", err = folder / "err";
  std::string program = MENISCUS_BINARY_DIR "/meniscus";
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv{program.data()};
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&files, 2, err.c_str(), O_WRONLY | O_CREAT, 0600);
  pid_t child = 0;
  if (posix_spawn(&child, program.c_str(), &files, nullptr, argv.data(), environ) != 0)
    throw std::runtime_error("cannot run " + program);
  posix_spawn_file_actions_destroy(&files);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "meniscus_test_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a directory");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void Folder::write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories(std::filesystem::path(*this / name).parent_path());
  std::ofstream(*this / name, std::ios::binary) << text;
}

std::string Folder::read(const std::string& name) const { return text_of(*this / name); }
bool Folder::has(const std::string& name) const { return std::filesystem::exists(*this / name); }

void Folder::write_block(const std::string& name, int n, float x) const {
  std::ostringstream text;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        text << x + 0.1f * static_cast<float>(i) << ' ' << 0.1f * static_cast<float>(j) << ' '
             << 0.1f * static_cast<float>(k) << '\n';
  write(name, text.str());
}

}  // namespace meniscus
