#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace mvtp {

/// One compressed picture of a video.
struct EncodedFrame {
  std::int64_t ms = 0;  ///< when it is shown
  bool key = false;     ///< can be decoded without those before it
  std::string data;
};

/// A WebM file (Matroska) with one track of VP9 in the colours that Chromium gives a canvas, with
/// an index of its key frames to jump to.
/// @param frames    in the order of time; the first is a key frame.
/// @param width     [pixels]
/// @param height    [pixels]
/// @param duration  [ms]
[[nodiscard]] std::string to_webm(std::span<const EncodedFrame> frames, int width, int height,
                                  std::int64_t duration);

}  // namespace mvtp
