#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "tools/view/browser.hpp"

namespace mvtp {

struct VideoRequest {
  std::optional<double> from;  ///< [s] of the run; none: when somebody is there first
  std::optional<double> to;    ///< [s] of the run; none: its end
  double speed = 1.0;          ///< seconds of the run per second of the video
  std::string colour;          ///< value of the page's menu of colours; empty: the page's choice
  Browser::Size size;
};

/// Plays a page as a video: 30 pictures a second, each drawn for its moment and compressed in the
/// browser, however long that takes.
/// @param page      path of a page that to_html() made
/// @param progress  told the share that is done
/// @param stop      looked at about once a second of the video
/// @return a WebM file; empty if it was stopped
/// @throws InputError if the run does not reach those times, or something is wrong with the browser
[[nodiscard]] std::string to_video(Browser& browser, const std::string& page,
                                   const VideoRequest& request,
                                   const std::function<void(double)>& progress,
                                   const std::atomic<bool>& stop);

}  // namespace mvtp
