/// Runs the built program, as a user would.
#pragma once

#include <string>
#include <vector>

namespace meniscus {

struct Outcome {
  int exit_code = -1;  ///< -1: it was ended by a signal
  std::string out, err;
};

/// Runs `meniscus` with these arguments; nothing is seen by a shell.
Outcome run_program(const std::vector<std::string>& arguments);

/// A directory of its own for a test, removed at the end.
class Folder {
 public:
  Folder();
  ~Folder();
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  bool has(const std::string& name) const;
  /// A frame of text: a block of n^3 particles 0.1 m apart, moved along x.
  void write_block(const std::string& name, int n = 5, float x = 0) const;

 private:
  std::string path_;
};

}  // namespace meniscus
