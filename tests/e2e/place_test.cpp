// The built program where nobody built it: it finds its own files, and holds no path of the machine
// that it was built on.

#include "program.h"
#include "source_folder.h"

#include <cstdio>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// The program in a folder of its own, without anything else of the source tree.
class ProgramElsewhere : public testing::Test {
protected:
    ProgramElsewhere() {
        fs::create_directories(folder_ / "bin");
        fs::copy(FANTASCOPE_PROGRAM, program_);
    }
    void copyData(const fs::path& to) {
        fs::create_directories(to);
        for (const char* name : {"assets", "config", "shows"})
            fs::copy(fs::path(sourceFolder()) / name, to / name, fs::copy_options::recursive);
    }
    Outcome rehearse(const std::vector<std::pair<std::string, std::string>>& environment = {}) {
        return runProgram({"rehearse", "--as-fast-as-possible", "--seconds", "0.2"}, folder_.path(), environment, program_);
    }
    ScratchFolder folder_;
    const fs::path program_ = folder_ / "bin/fantascope";
};

TEST_F(ProgramElsewhere, finds_its_files_above_it) {
    copyData(folder_.path());
    EXPECT_THAT(rehearse(), exits(0));
}

TEST_F(ProgramElsewhere, finds_its_files_where_it_is_installed) {
    copyData(folder_ / "share/fantascope");
    EXPECT_THAT(rehearse(), exits(0));
}

TEST_F(ProgramElsewhere, says_where_it_looked_and_what_to_do) {
    const Outcome lost = rehearse();
    EXPECT_THAT(lost, exits(1));
    EXPECT_THAT(lost.errors, AllOf(HasSubstr(program_.string()), HasSubstr("set FANTASCOPE_DATA")));
    const Outcome misled = rehearse({{"FANTASCOPE_DATA", folder_.path()}});
    EXPECT_THAT(misled, exits(1));
    EXPECT_THAT(misled.errors, HasSubstr("FANTASCOPE_DATA is " + folder_.path().string()));
    EXPECT_THAT(rehearse({{"FANTASCOPE_DATA", sourceFolder()}}), exits(0));
}

// In what is loaded: symbols for a debugger may say where they are from.
TEST(Program, holds_no_path_of_the_source_tree) {
    FILE* const pipe = ::popen(("strings --data " FANTASCOPE_PROGRAM " | grep -F " + sourceFolder()).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::string found;
    for (char buffer[256]; std::fgets(buffer, sizeof buffer, pipe) != nullptr;) found += buffer;
    EXPECT_EQ(::pclose(pipe), 1 << 8) << "grep finds nothing";
    EXPECT_THAT(found, IsEmpty());
}

}  // namespace
}  // namespace fantascope
