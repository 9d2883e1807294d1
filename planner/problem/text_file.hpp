#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mvtp {

/// The whole content of a UTF-8 text file, without a byte-order mark.
///
/// Reads block by block, so that an endless or binary source (/dev/zero, a video) fails at once.
/// @throws InputError if `path` is missing, a directory, unreadable, empty, larger than
/// `max_bytes`, or holds bytes that no text has (NUL, other control characters, invalid UTF-8).
[[nodiscard]] std::string read_text_file(const std::string& path, std::size_t max_bytes);

/// Finds out before any long work whether write_text_file(path, ...) can succeed.
/// Leaves no trace. @throws InputError with the system's reason and a remedy.
void check_writable(const std::string& path);

/// Replaces the file at `path` by `content`, whole or not at all: writes beside it, then renames.
///
/// A symbolic link stays one (its target is replaced); a device or pipe is written directly.
/// @throws InputError with the system's reason; no partial file is left behind.
void write_text_file(const std::string& path, std::string_view content);

/// A field of a CSV file [RFC 4180]; quoted where its text demands it.
[[nodiscard]] std::string csv_field(const std::string& text);

}  // namespace mvtp
