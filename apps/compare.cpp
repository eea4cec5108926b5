#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "meniscus/image.h"
#include "meniscus/output.h"

namespace meniscus::apps {
namespace {

constexpr double kEqualPsnrDb = 999;  ///< JSON has no infinity

struct CompareArguments {
  std::string a, b;
  bool json = false;
  std::optional<double> min_psnr_db;
};

void compare_pictures(const CompareArguments& arguments) {
  const Image<Rgb8> a = read_png(arguments.a), b = read_png(arguments.b);
  if (a.width() != b.width() || a.height() != b.height())
    throw Error(ErrorCode::unsupported, {"pictures of different sizes cannot be compared",
                                         fmt::format("{}x{} as {}", a.width(), a.height(), arguments.a),
                                         fmt::format("{}x{}", b.width(), b.height()),
                                         arguments.b,
                                         {},
                                         {},
                                         {}});
  const ImageDifference difference = compare(a, b);
  const double psnr_db = std::isfinite(difference.psnr_db) ? std::min(difference.psnr_db, kEqualPsnrDb) : kEqualPsnrDb;
  if (arguments.json) {
    nlohmann::ordered_json json;
    json["psnr_db"] = psnr_db;
    json["ssim"] = difference.ssim;
    json["max_difference"] = difference.max_difference;
    json["pixels_differing"] = difference.pixels_differing;
    std::cout << json.dump() << '\n';
  } else {
    std::cout << fmt::format("psnr              {}\n",
                             psnr_db == kEqualPsnrDb ? "equal pictures" : fmt::format("{:.2f} dB", psnr_db))
              << fmt::format("ssim              {:.6f}\n", difference.ssim)
              << fmt::format("max difference    {:.0f} of 255\n", difference.max_difference)
              << fmt::format("pixels differing  {} of {}\n", difference.pixels_differing, a.size());
  }
  if (arguments.min_psnr_db && psnr_db < *arguments.min_psnr_db) {
    std::cerr << fmt::format(
        "meniscus: error: {}: the pictures differ too much (expected at least {} dB, found {:.2f} dB)\n", arguments.b,
        *arguments.min_psnr_db, psnr_db);
    throw CLI::RuntimeError(kFailed);
  }
}

}  // namespace

void add_compare(CLI::App& program) {
  CLI::App* command = program.add_subcommand("compare", "Tell how far two PNG pictures differ");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("A", arguments->a, "A PNG picture")->required()->type_name("");
  command->add_option("B", arguments->b, "Another of the same size")->required()->type_name("");
  command->add_flag("--json", arguments->json, "Print one JSON object; psnr_db is 999 for equal pictures");
  command
      ->add_option_function<double>(
          "--min-psnr", [arguments](double v) { arguments->min_psnr_db = v; },
          "Exit with 1 if the pictures are less alike than this, dB")
      ->type_name("DB");
  command->callback([arguments] { compare_pictures(*arguments); });
}

}  // namespace meniscus::apps
