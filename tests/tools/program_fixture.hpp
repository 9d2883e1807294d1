#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "tests/temporary_directory.hpp"

namespace mvtp {

struct Outcome {
  int exit_code = 0;  ///< 128 + signal if a signal ended it, as a shell says
  std::string out;
  std::string err;
};

/// Runs the built program as a user would: through the shell, in a directory of the test.
class Program : public testing::Test {
 protected:
  [[nodiscard]] Outcome run(const std::string& arguments) const {
    return shell(std::string("'") + MVTP_PROGRAM + "' " + arguments);
  }

  /// Runs a piece of shell script.
  [[nodiscard]] Outcome shell(const std::string& script) const {
    const std::string command = "{ cd '" + directory_.path("") + "' || exit 98\n" + script +
                                "\n} >'" + streams_.path("out") + "' 2>'" + streams_.path("err") +
                                "'";
    const int status = std::system(command.c_str());
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return {code, content_of(streams_.path("out")), content_of(streams_.path("err"))};
  }

  /// Bad input: exit code 2, one line on stderr that matches, nothing on stdout.
  void expect_refused(const std::string& arguments, const std::string& regex) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.err, testing::MatchesRegex("mvtp: " + regex + "\n")) << arguments;
    EXPECT_THAT(outcome.out, testing::IsEmpty()) << arguments;
  }

  TemporaryDirectory directory_;  ///< what the program sees
  TemporaryDirectory streams_;    ///< what it prints
};

}  // namespace mvtp
