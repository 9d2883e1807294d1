#include "tools/toio/cube/mat.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "planner/problem/document.hpp"
#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"
#include "tools/cli/suggest.hpp"

namespace mvtp {
namespace {

constexpr double kCollectionScale = 0.0013625;  // 560 mm over 411 dots
constexpr double kDeveloperScale = 0.001375;    // 1188 mm over 864 dots
constexpr std::size_t kMaxBytes = 1'000'000;

/// The A3 sheets #1-#12: three columns of four, numbered down each column.
void add_developer_mats(std::vector<Mat>& mats) {
  constexpr int kLeft[] = {34, 340, 645};
  constexpr int kWidth[] = {305, 304, 304};
  constexpr int kTop[] = {35, 251, 467, 683};
  constexpr int kHeight = 215;
  for (int i = 0; i < 12; ++i) {
    const int column = i / 4;
    const int row = i % 4;
    mats.push_back({fmt::format("developer-{}", i + 1), kLeft[column], kTop[row],
                    kLeft[column] + kWidth[column], kTop[row] + kHeight, kDeveloperScale});
  }
}

std::vector<Mat> all_mats() {
  std::vector<Mat> mats = {
      {"simple", 98, 142, 402, 358, kCollectionScale},
      {"collection-ring", 45, 45, 455, 455, kCollectionScale},
      {"collection-tiles", 545, 45, 955, 455, kCollectionScale},
      {"gesundroid", 1050, 45, 1460, 455, kCollectionScale},
      {"developer-all", 34, 35, 949, 898, kDeveloperScale},
  };
  add_developer_mats(mats);
  std::ranges::stable_sort(mats, {}, [](const Mat& m) { return m.width() * m.height(); });
  return mats;
}

int dots(const Value& value) {
  const double number = value.number("dots");
  if (number < 0 || number > 65534 || number != double(int(number))) {
    throw InputError(value.where(), fmt::format("is {}; give whole dots from 0 to 65534", number));
  }
  return int(number);
}

Mat read_mat(const std::string& path) {
  const Document document =
      Document::parse(path, read_text_file(path, kMaxBytes), {"range"}, "a mat file");
  const Value root = document.root();
  root.require_map("{name: mine, range: [98, 142, 402, 358], mm_per_dot: 1.3625}");
  root.require_known_keys({"name", "range", "mm_per_dot"});
  const Value range = root.at("range");
  range.require_list(4, 4, "[98, 142, 402, 358]");
  Mat mat;
  mat.name = root.find("name") ? root.at("name").text() : "mat";
  mat.min_x = dots(range[0]);
  mat.min_y = dots(range[1]);
  mat.max_x = dots(range[2]);
  mat.max_y = dots(range[3]);
  if (mat.max_x <= mat.min_x || mat.max_y <= mat.min_y) {
    throw InputError(range.where(), "is empty; give [least x, least y, largest x, largest y]");
  }
  if (const auto scale = root.find("mm_per_dot")) {
    mat.metres_per_dot = scale->positive("mm") / 1000.0;
    if (mat.metres_per_dot < 0.0005 || mat.metres_per_dot > 0.005) {
      throw InputError(scale->where(),
                       fmt::format("is {} mm; toio's own mats have 1.36 to 1.38 mm per dot",
                                   mat.metres_per_dot * 1000.0));
    }
  }
  return mat;
}

}  // namespace

std::span<const Mat> known_mats() {
  static const std::vector<Mat> mats = all_mats();
  return mats;
}

Mat find_mat(const std::string& name_or_file) {
  for (const Mat& mat : known_mats()) {
    if (mat.name == name_or_file) return mat;
  }
  if (std::filesystem::exists(name_or_file)) return read_mat(name_or_file);
  std::vector<std::string> names;
  for (const Mat& mat : known_mats()) names.push_back(mat.name);
  throw InputError("--mat", fmt::format("is \"{}\", neither a mat nor a file; {}choose simple, "
                                        "collection-ring, collection-tiles, gesundroid, "
                                        "developer-1 ... developer-12, developer-all, or give a "
                                        "file with the range in dots",
                                        name_or_file, did_you_mean(name_or_file, names)));
}

}  // namespace mvtp
