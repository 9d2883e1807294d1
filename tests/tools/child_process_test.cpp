#include "tools/cli/child_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <string>
#include <vector>

#include "planner/problem/input_error.hpp"
#include "tools/cli/progress.hpp"

namespace mvtp {
namespace {

using testing::ElementsAre;

Job sh(const std::string& script, std::size_t tag = 0) {
  Job job;
  job.arguments = {"/bin/sh", "-c", script};
  job.tag = tag;
  return job;
}

/// Gives out jobs, and notes how they end: "TAG:CODE", or "TAG:SIGNAL!".
class Jobs : public JobSource {
 public:
  explicit Jobs(std::vector<Job> jobs) : jobs_(std::move(jobs)) {}

  std::optional<Job> next() override {
    if (jobs_.empty()) return std::nullopt;
    Job job = jobs_.front();
    jobs_.erase(jobs_.begin());
    return job;
  }
  bool finished(const Job& job, const JobEnd& end) override {
    const bool exited = WIFEXITED(end.status);
    ends.push_back(std::to_string(job.tag) + ":" +
                   std::to_string(exited ? WEXITSTATUS(end.status) : WTERMSIG(end.status)) +
                   (exited ? "" : "!"));
    last = end;
    if (job.tag == 1) jobs_.push_back(sh("exit 7", 8));
    return job.tag != 9;
  }

  std::vector<std::string> ends;
  JobEnd last;

 private:
  std::vector<Job> jobs_;
};

TEST(RunJobs, AnEndMayLeadToFurtherJobs) {
  Jobs jobs({sh("exit 3", 1), sh("kill -SEGV $$", 2)});
  EXPECT_TRUE(run_jobs(jobs, 1));
  EXPECT_THAT(jobs.ends, ElementsAre("1:3", "2:11!", "8:7"));
}

TEST(RunJobs, WhoOverstaysIsKilled) {
  Job slow = sh("exec sleep 100", 4);
  slow.time_limit = 0.05;
  Jobs jobs({slow});
  EXPECT_TRUE(run_jobs(jobs, 1));
  EXPECT_THAT(jobs.ends, ElementsAre("4:9!"));
  EXPECT_TRUE(jobs.last.out_of_time);
}

TEST(RunJobs, MemoryIsMeasuredByJob) {
  const auto peak = [](const std::string& block) {
    Jobs jobs({sh("exec dd if=/dev/zero of=/dev/null count=1 bs=" + block + " 2>/dev/null")});
    EXPECT_TRUE(run_jobs(jobs, 1));
    return jobs.last.peak_rss;
  };
  const double small = peak("1M");
  EXPECT_GT(peak("300M"), small + 100.0);
}

TEST(RunJobs, AJobMayEndEverything) {
  Jobs jobs({sh("exec sleep 100", 5), sh("sleep 0.05", 9), sh("exit 0", 6)});
  EXPECT_TRUE(run_jobs(jobs, 2));
  EXPECT_THAT(jobs.ends, ElementsAre("9:0", "5:15!"));
  EXPECT_TRUE(jobs.last.interrupted);
}

//   Nobody is left behind if a job cannot be started.
TEST(RunJobs, WhatRunsIsEndedIfTheNextCannotStart) {
  Job missing;
  missing.arguments = {"/no/such/program"};
  Jobs jobs({sh("exec sleep 100"), missing});
  EXPECT_THROW((void)run_jobs(jobs, 2), InputError);
  EXPECT_EQ(waitpid(-1, nullptr, 0), -1);
}

TEST(TimeLeft, IsSaidInAUnitThatFits) {
  EXPECT_EQ(time_left(10.0, 0.5), "10 s left");
  EXPECT_EQ(time_left(60.0, 0.1), "9 min left");
  EXPECT_EQ(time_left(3600.0, 0.25), "3.0 h left");
  EXPECT_EQ(time_left(10.0, 0.0), "");
  EXPECT_EQ(time_left(10.0, 1.0), "");
}

}  // namespace
}  // namespace mvtp
