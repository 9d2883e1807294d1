#include "traci_bridge/packed_file.hpp"

#include <zlib.h>

#include <array>
#include <memory>
#include <type_traits>

#include "planner/problem/input_error.hpp"

namespace mvtp {
namespace {

using Block = std::array<char, 1 << 16>;

}  // namespace

std::string unpacked(const std::string& path) {
  const gzFile file = gzopen(path.c_str(), "rb");
  std::string text;
  Block block;
  int count = 0;
  while (file != nullptr && (count = gzread(file, block.data(), block.size())) > 0) {
    text.append(block.data(), std::size_t(count));
  }
  const bool good = file != nullptr && gzclose(file) == Z_OK && count == 0;
  if (!good) throw InputError(path, "cannot be unpacked; make it anew with gzip");
  return text;
}

void for_each_tag(const std::string& path, const std::function<void(std::string_view)>& see) {
  const auto close = [](gzFile open) { gzclose(open); };
  // zlib reads a file that is not packed as it is.
  const std::unique_ptr<std::remove_pointer_t<gzFile>, decltype(close)> file(
      gzopen(path.c_str(), "rb"), close);
  if (!file) return;
  std::string tag;
  Block block;
  for (int count = 0; (count = gzread(file.get(), block.data(), block.size())) > 0;) {
    std::string_view rest(block.data(), std::size_t(count));
    for (std::size_t end = 0; (end = rest.find('>')) != std::string_view::npos;) {
      tag += rest.substr(0, end);
      see(tag);
      tag.clear();
      rest.remove_prefix(end + 1);
    }
    tag += rest;
  }
}

}  // namespace mvtp
