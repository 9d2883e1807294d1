#include "tools/view/webm.hpp"

#include <bit>
#include <vector>

namespace mvtp {
namespace {

// The elements of Matroska that are used, RFC 9559, by their ids.
constexpr std::uint32_t kEbml = 0x1A45DFA3;
constexpr std::uint32_t kSegment = 0x18538067;
constexpr std::uint32_t kInfo = 0x1549A966;
constexpr std::uint32_t kTracks = 0x1654AE6B;
constexpr std::uint32_t kCues = 0x1C53BB6B;
constexpr std::uint32_t kCluster = 0x1F43B675;
constexpr std::uint32_t kSimpleBlock = 0xA3;

constexpr std::int64_t kLongestCluster = 30'000;  // [ms]; a block counts from it in 16 bits

std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int k = bytes - 1; k >= 0; --k) text.push_back(static_cast<char>(value >> (8 * k) & 0xff));
  return text;
}

/// Its id, its size in 8 bytes, and what is in it.
std::string element(std::uint32_t id, const std::string& content) {
  int bytes = 1;
  while (bytes < 4 && id >> (8 * bytes) != 0) ++bytes;
  return big_endian(id, bytes) + big_endian(content.size() | std::uint64_t{1} << 56, 8) + content;
}

std::string number(std::uint32_t id, std::uint64_t value) {
  return element(id, big_endian(value, 8));
}

std::string real(std::uint32_t id, double value) {
  return element(id, big_endian(std::bit_cast<std::uint64_t>(value), 8));
}

std::string head() {
  return element(kEbml, number(0x4286, 1) + number(0x42F7, 1) + number(0x42F2, 4) +
                            number(0x42F3, 8) + element(0x4282, "webm") + number(0x4287, 2) +
                            number(0x4285, 2));
}

std::string info(std::int64_t duration) {
  constexpr std::uint64_t kNanosecondsPerTick = 1'000'000;
  return element(kInfo, number(0x2AD7B1, kNanosecondsPerTick) + real(0x4489, double(duration)) +
                            element(0x4D80, "mvtp") + element(0x5741, "mvtp"));
}

std::string tracks(int width, int height) {
  // As Chromium compresses a canvas: BT.709 in the full range, with the transfer of sRGB.
  const std::string colour = element(
      0x55B0, number(0x55B1, 1) + number(0x55B9, 2) + number(0x55BA, 13) + number(0x55BB, 1));
  const std::string picture = element(
      0xE0, number(0xB0, std::uint64_t(width)) + number(0xBA, std::uint64_t(height)) + colour);
  return element(kTracks, element(0xAE, number(0xD7, 1) + number(0x73C5, 1) + number(0x83, 1) +
                                            element(0x86, "V_VP9") + picture));
}

/// Pictures from a key frame on.
struct Cluster {
  std::int64_t ms = 0;
  std::string bytes;
};

std::vector<Cluster> clusters(std::span<const EncodedFrame> frames) {
  std::vector<Cluster> all;
  std::string content;
  const auto close = [&] {
    if (!all.empty()) all.back().bytes = element(kCluster, content);
  };
  for (const EncodedFrame& frame : frames) {
    if (all.empty() || frame.key || frame.ms - all.back().ms > kLongestCluster) {
      close();
      all.push_back({frame.ms, {}});
      content = number(0xE7, std::uint64_t(frame.ms));
    }
    content += element(kSimpleBlock, std::string(1, '\x81') +
                                         big_endian(std::uint64_t(frame.ms - all.back().ms), 2) +
                                         std::string(1, frame.key ? '\x80' : '\0') + frame.data);
  }
  close();
  return all;
}

/// Where each cluster begins, in a segment in which the first one is `before` bytes from its start.
std::string cues(const std::vector<Cluster>& all, std::size_t before) {
  std::string content;
  for (const Cluster& cluster : all) {
    content += element(0xBB, number(0xB3, std::uint64_t(cluster.ms)) +
                                 element(0xB7, number(0xF7, 1) + number(0xF1, before)));
    before += cluster.bytes.size();
  }
  return element(kCues, content);
}

}  // namespace

std::string to_webm(std::span<const EncodedFrame> frames, int width, int height,
                    std::int64_t duration) {
  const std::vector<Cluster> all = clusters(frames);
  std::string segment = info(duration) + tracks(width, height);
  segment += cues(all, segment.size() + cues(all, 0).size());  // as long whatever it says
  for (const Cluster& cluster : all) segment += cluster.bytes;
  return head() + element(kSegment, segment);
}

}  // namespace mvtp
