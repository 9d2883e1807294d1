#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace mvtp {

/// What a file holds that gzip has packed. @throws InputError
[[nodiscard]] std::string unpacked(const std::string& path);

/// Hands on each tag of an XML file, packed or not, without its '>' and with the text before it;
/// the file is never in memory as a whole. Ends where it cannot be read: for those to whom it does
/// not matter what is wrong with it.
void for_each_tag(const std::string& path, const std::function<void(std::string_view)>& see);

}  // namespace mvtp
