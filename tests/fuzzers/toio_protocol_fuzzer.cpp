#include <cstdio>
#include <cstdlib>

#include "tests/tools/toio/protocol_laws.hpp"

/// libFuzzer's door to the decoders; tools/fuzz.sh runs it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  int understood = 0;
  const auto broken = mvtp::broken_law({data, size}, understood);
  if (broken) {
    std::fprintf(stderr, "%s\n", broken->c_str());
    std::abort();
  }
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  (void)mvtp::from_hex(text);
  (void)mvtp::characteristic_of(text);
  return 0;
}
