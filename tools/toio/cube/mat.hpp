#pragma once

#include <span>
#include <string>

namespace mvtp {

[[nodiscard]] inline double in_mm(double metres) { return metres * 1000.0; }

/// A mat printed with the pattern by which cubes know where they are.
///
/// The range is that of the coordinates on it, in dots, x right and y down. Sources: toio Core Cube
/// Specification 2.5.0, hardware_position_id; developer mats TMD01SS: toio SDK for Unity, Mat.cs.
struct Mat {
  std::string name;
  int min_x = 0;
  int min_y = 0;
  int max_x = 0;
  int max_y = 0;
  double metres_per_dot = 0.0013625;

  [[nodiscard]] double width() const { return (max_x - min_x) * metres_per_dot; }
  [[nodiscard]] double height() const { return (max_y - min_y) * metres_per_dot; }

  friend bool operator==(const Mat&, const Mat&) = default;
};

/// The mats that have a name, the smallest first.
[[nodiscard]] std::span<const Mat> known_mats();

/// The mat of that name, or of that file: "{name: mine, range: [98, 142, 402, 358], mm_per_dot:
/// 1.36}" as YAML or JSON.
/// @throws InputError if it is neither, or the file is none of a mat.
[[nodiscard]] Mat find_mat(const std::string& name_or_file);

}  // namespace mvtp
