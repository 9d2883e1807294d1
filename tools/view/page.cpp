#include "tools/view/page.hpp"

#include <zlib.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "planner/problem/input_error.hpp"
#include "tools/view/base64.hpp"
#include "tools/view/page_template.hpp"

namespace mvtp {
namespace {

// A replay in the page: <script ...> base64(zlib(length of the header, header, frames)) </script>
constexpr std::string_view kOpening = "<script type=\"application/x-mvtp-replay\">";
constexpr std::string_view kClosing = "</script>";
constexpr std::string_view kTitleMark = "{{title}}";
constexpr std::string_view kReplaysMark = "{{replays}}";
constexpr std::size_t kLengthBytes = 4;
constexpr std::size_t kLargestReplay = std::size_t{1} << 30;  // [bytes], against archive bombs

std::string compress(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  // Fails only if the buffer is too small, which compressBound() excludes, or memory runs out.
  if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK) {
    throw std::bad_alloc();
  }
  packed.resize(size);
  return packed;
}

std::optional<std::string> decompress(const std::string& packed) {
  std::string bytes;
  uLongf size = 0;
  for (std::size_t room = std::max<std::size_t>(1 << 16, packed.size() * 8); room <= kLargestReplay;
       room *= 2) {
    bytes.resize(room);
    size = room;
    const int result = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                  reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    if (result == Z_OK) {
      bytes.resize(size);
      return bytes;
    }
    if (result != Z_BUF_ERROR) return std::nullopt;
  }
  return std::nullopt;
}

std::string pack(const Replay& replay) {
  std::string bytes;
  for (std::size_t k = 0; k < kLengthBytes; ++k) {
    bytes.push_back(static_cast<char>(replay.header.size() >> (8 * k) & 0xffU));
  }
  return to_base64(compress(bytes + replay.header + replay.frames));
}

std::optional<Replay> unpack(std::string_view text) {
  const std::optional<std::string> packed = from_base64(text);
  const std::optional<std::string> bytes = packed ? decompress(*packed) : std::nullopt;
  if (!bytes || bytes->size() < kLengthBytes) return std::nullopt;
  std::size_t length = 0;
  for (std::size_t k = 0; k < kLengthBytes; ++k) {
    length |= std::size_t{static_cast<unsigned char>((*bytes)[k])} << (8 * k);
  }
  if (length > bytes->size() - kLengthBytes) return std::nullopt;

  Replay replay{"", bytes->substr(kLengthBytes, length), bytes->substr(kLengthBytes + length)};
  const auto header = nlohmann::json::parse(replay.header, nullptr, false);
  if (!header.is_object() || !header.contains("title") || !header["title"].is_string()) {
    return std::nullopt;
  }
  replay.title = header["title"].get<std::string>();
  return replay;
}

std::string escape(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped.push_back(c);
    }
  }
  return escaped;
}

std::string title_of(std::span<const Replay> replays) {
  std::string title;
  for (const Replay& replay : replays) {
    if (replay.title.empty() || title == replay.title) continue;
    title += (title.empty() ? "" : " | ") + replay.title;
  }
  return title.empty() ? "mvtp replay" : title;
}

}  // namespace

std::string to_html(std::span<const Replay> replays) {
  const std::string_view page = kPageTemplate;
  const std::size_t title = page.find(kTitleMark);
  const std::size_t data = page.find(kReplaysMark);

  std::string html(page.substr(0, title));
  html += escape(title_of(replays));
  html += page.substr(title + kTitleMark.size(), data - title - kTitleMark.size());
  for (const Replay& replay : replays) {
    html.append(kOpening).append(pack(replay)).append(kClosing).append("\n");
  }
  html += page.substr(data + kReplaysMark.size());
  return html;
}

std::vector<Replay> replays_of(const std::string& html, const std::string& where) {
  std::vector<Replay> replays;
  std::size_t begin = 0;
  while ((begin = html.find(kOpening, begin)) != std::string::npos) {
    begin += kOpening.size();
    const std::size_t end = html.find(kClosing, begin);
    std::optional<Replay> replay;
    if (end != std::string::npos)
      replay = unpack(std::string_view(html).substr(begin, end - begin));
    if (!replay) {
      throw InputError(where, "replay " + std::to_string(replays.size() + 1) +
                                  " in the page is damaged; write the page again");
    }
    replays.push_back(*std::move(replay));
  }
  if (replays.empty()) {
    throw InputError(where,
                     "holds no replay; give a page written by `mvtp coordinate` or `mvtp view`");
  }
  return replays;
}

}  // namespace mvtp
