#include "tools/cli/output_files.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "planner/problem/input_error.hpp"
#include "planner/problem/text_file.hpp"

namespace mvtp {
namespace {

namespace fs = std::filesystem;

/// Do the two name the same regular file? Terminals and the like may be read and written.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::exists(a, error) && fs::exists(b, error)) {
    return fs::is_regular_file(a, error) && fs::equivalent(a, b, error) && !error;
  }
  const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, error), error);
  const fs::path whole_b = fs::weakly_canonical(fs::absolute(b, error), error);
  return !error && whole_a == whole_b;
}

}  // namespace

void check_output_files(const std::vector<std::string>& outputs,
                        const std::vector<std::string>& inputs) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->empty()) continue;
    for (const std::string& input : inputs) {
      if (!input.empty() && same_file(*output, input)) {
        throw InputError(*output,
                         fmt::format("is an input too ({}); choose another output file", input));
      }
    }
    for (auto other = outputs.begin(); other != output; ++other) {
      if (!other->empty() && same_file(*output, *other)) {
        throw InputError(*output, "is named for two outputs; choose another file for one of them");
      }
    }
    check_writable(*output);
  }
}

}  // namespace mvtp
