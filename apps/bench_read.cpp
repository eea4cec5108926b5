#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>

#include "bench_options.h"
#include "bench_read_files.h"
#include "bench_timing.h"
#include "commands.h"
#include "meniscus/io.h"
#include "meniscus/render.h"

namespace meniscus::apps {
namespace {

struct ReadArguments {
  std::string format = "vtp";
  std::size_t particles = 10'000'000;
  int repeats = 5;
  int threads = 0;
  bool json = false;
};

/// A file in the folder for temporary files, removed at the end.
class BenchFile {
 public:
  explicit BenchFile(const std::string& ending)
      : path_((std::filesystem::temp_directory_path() / fmt::format("meniscus_bench_read_{}{}", ::getpid(), ending))
                  .string()) {}
  ~BenchFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  BenchFile(const BenchFile&) = delete;
  BenchFile& operator=(const BenchFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// What it takes to fetch the file's bytes into memory that has been written before, by all threads.
double copy_once(const std::string& path, std::vector<char>& buffer) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  const auto start = Clock::now();
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  parallel_for(buffer.size(), kPiece, [&](std::size_t begin, std::size_t end) {
    while (begin < end) {
      const ssize_t count = ::pread(file, buffer.data() + begin, end - begin, static_cast<off_t>(begin));
      if (count <= 0) break;
      begin += static_cast<std::size_t>(count);
    }
  });
  ::close(file);
  return ms_since(start);
}

void write_tank(const std::string& format, const std::string& path, std::size_t count) {
  Particles particles = synthetic_tank(count, 1);
  if (!particles.find("velocity")) {
    Attribute& velocity = particles.attributes.emplace_back(Attribute{"velocity", 3, {}});
    velocity.values.resize(3 * particles.size());
    for (std::size_t i = 0; i < particles.size(); ++i) velocity.values[3 * i] = particles.y[i];
  }
  write_for_bench(format, path, particles);
}

Json measure(const ReadArguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  const BenchFile file("." + arguments.format);
  ReadOptions options;
  if (arguments.format == "raw") options.raw = kRawForm;
  // A small one first, as programs look at their frames before they read them: what all readings share begins there.
  constexpr std::size_t kFew = 1000;
  write_tank(arguments.format, file.path(), std::min(kFew, arguments.particles));
  read_particles(file.path(), options);
  write_tank(arguments.format, file.path(), arguments.particles);
  const auto bytes = static_cast<std::size_t>(std::filesystem::file_size(file.path()));
  std::vector<double> read_ms, copy_ms;
  std::vector<char> buffer(bytes);
  std::size_t particles = 0;
  for (int i = 0; i <= arguments.repeats; ++i) {  // the first one warms up
    const double copied = copy_once(file.path(), buffer);
    const auto start = Clock::now();
    particles = read_particles(file.path(), options).size();
    const double read = ms_since(start);
    if (i == 0) continue;
    copy_ms.push_back(copied);
    read_ms.push_back(read);
  }
  Json json;
  json["format"] = arguments.format;
  json["particles"] = particles;
  json["bytes"] = bytes;
  json["threads"] = thread_count();
  json["read_ms"] = median(read_ms);
  json["copy_ms"] = median(copy_ms);
  json["ratio"] = median(copy_ms) / median(read_ms);
  json["mb_per_s"] = static_cast<double>(bytes) / 1e3 / median(read_ms);
  return json;
}

void print(const Json& json) {
  std::cout << fmt::format(
      "{} particles as {}, {:.1f} MB: read in {:.1f} ms, {:.0f} MB/s; copied in {:.1f} ms: {:.2f} "
      "of its speed\n",
      json["particles"].get<std::size_t>(), json["format"].get<std::string>(), json["bytes"].get<double>() / 1e6,
      json["read_ms"].get<double>(), json["mb_per_s"].get<double>(), json["copy_ms"].get<double>(),
      json["ratio"].get<double>());
}

}  // namespace

void add_bench_read(CLI::App& bench) {
  CLI::App* command = bench.add_subcommand("read", "Reading a frame against copying its bytes");
  const auto arguments = std::make_shared<ReadArguments>();
  command
      ->add_option("--format", arguments->format,
                   "vtk, vtp, ply, npz, bgeo, hdf5 or csv: positions and velocities; npy or raw: positions (default: "
                   "vtp)")
      ->type_name("F")
      ->check(CLI::IsMember({"vtk", "vtp", "ply", "npz", "bgeo", "hdf5", "csv", "npy", "raw"}).description(""));
  add_particles(*command, arguments->particles, 1, 200'000'000, "Particles in the file (default: 10000000)");
  add_repeat(*command, arguments->repeats, "Runs that the median is taken of (default: 5)");
  add_threads(*command, arguments->threads);
  add_json(*command, arguments->json);
  command->footer(
      "copy_ms is the time in which all threads fetch the file's bytes out of the system's cache into memory that was\n"
      "written before; ratio is copy_ms / read_ms.");
  run_with(*command, arguments, measure, print);
}

}  // namespace meniscus::apps
