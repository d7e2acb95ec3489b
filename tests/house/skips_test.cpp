// How ctest and tools/run-tests handle a program whose tests pass, skip, fail or hang.

#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

namespace fantascope::house {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Outcome {
    int status = -1;
    std::string said;
};

// Runs tools/run-tests on the entry `name` of this folder's CMakeLists.txt, with ctest's files in a
// separate folder, because this test runs under ctest, too.
Outcome runEntry(const std::string& name, const std::string& environment = "") {
    const ScratchFolder folder;
    std::ofstream(folder / "CTestTestfile.cmake") << "subdirs(\"" FANTASCOPE_HOUSE_BUILD "\")\n";
    const std::string command = fmt::format(
        "env -u GTEST_FILTER -u FANTASCOPE_REFUSE_SKIPS CTEST_OUTPUT_ON_FAILURE=1 {} {}/tools/run-tests --test-dir {} -C "
        "deliberate -R '^{}$' 2>&1",
        environment, sourceFolder(), folder.path().string(), name);
    FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) return {};
    Outcome outcome;
    for (char buffer[256]; std::fgets(buffer, sizeof buffer, pipe) != nullptr;) outcome.said += buffer;
    const int waited = ::pclose(pipe);
    outcome.status = WIFEXITED(waited) ? WEXITSTATUS(waited) : -1;
    return outcome;
}

// Example failure: one missing peer hides whatever else its test program found.
TEST(Skips, never_hide_a_failure) {
    const Outcome outcome = runEntry("deliberately_skips_and_fails");
    EXPECT_NE(outcome.status, 0) << outcome.said;
    EXPECT_THAT(outcome.said, AllOf(HasSubstr("deliberately_skips_and_fails (Failed)"), HasSubstr("0% tests passed")));
}

TEST(Skips, are_told_with_their_reason_and_pass_by_default) {
    const Outcome outcome = runEntry("deliberately_skips");
    EXPECT_EQ(outcome.status, 0) << outcome.said;
    EXPECT_THAT(outcome.said,
                AllOf(HasSubstr("deliberately_skips (Skipped)"), HasSubstr("skipped: Deliberately.skips: there is no peer")));
}

TEST(Skips, are_refused_where_asked) {
    const Outcome outcome = runEntry("deliberately_skips", "FANTASCOPE_REFUSE_SKIPS=1");
    EXPECT_EQ(outcome.status, 1) << outcome.said;
    EXPECT_THAT(outcome.said, HasSubstr("skipped: Deliberately.skips: there is no peer"));
    EXPECT_EQ(runEntry("deliberately_passes", "FANTASCOPE_REFUSE_SKIPS=1").status, 0);
}

// Example failure: a renamed test leaves .ci/run with a filter that runs nothing and passes.
TEST(Skips, a_filter_that_wants_no_test_fails) { EXPECT_NE(runEntry("deliberately_runs_nothing").status, 0); }

// Example failure: a program is ended after its timeout, and nobody knows which of its 400 tests
// hung.
TEST(Hangs, are_named) {
    const Outcome outcome = runEntry("deliberately_hangs", "FANTASCOPE_TEST_PATIENCE=1");
    EXPECT_NE(outcome.status, 0) << outcome.said;
    EXPECT_THAT(outcome.said, HasSubstr("Deliberately.hangs hangs"));
}

}  // namespace
}  // namespace fantascope::house
