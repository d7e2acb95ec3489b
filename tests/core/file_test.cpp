#include "core/file.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST(File, bytes_come_back_as_they_were_written) {
    const ScratchFolder folder;
    const std::string bytes("\0\xff\r\n\x1a rest", 10);
    ASSERT_TRUE(writeFile(folder / "a", bytes));
    EXPECT_EQ(*readFile(folder / "a"), bytes);
    ASSERT_TRUE(writeFile(folder / "a", ""));
    EXPECT_EQ(*readFile(folder / "a"), "");
}

TEST(File, its_start_is_read_alone) {
    const ScratchFolder folder;
    const std::string body(200'000, 'x');
    const auto file = folder.file("a", body + "end");
    EXPECT_EQ(*readStart(file, 3), "xxx");
    EXPECT_EQ(*readStart(file, 200'001), body + "e");
    EXPECT_EQ(*readStart(file, 1'000'000), body + "end");
    EXPECT_EQ(*readFile(file), body + "end");
}

TEST(File, writing_makes_missing_folders_and_leaves_only_the_file) {
    const ScratchFolder folder;
    ASSERT_TRUE(writeFile(folder / "new/deep/a", "x"));
    EXPECT_EQ(*readFile(folder / "new/deep/a"), "x");
    ASSERT_TRUE(writeFile(folder / "b", std::string(1 << 20, 'b')));
    EXPECT_THAT(folder.names(), ElementsAre("b", "new"));
}

TEST(File, a_file_that_cannot_be_read_is_named_with_the_reason) {
    const ScratchFolder folder;
    EXPECT_EQ(readFile(folder / "none").error().message(),
              (folder / "none").string() + ": cannot be read: No such file or directory");
    EXPECT_EQ(readFile(folder / "").error().message(), (folder / "").string() + ": is a folder, a file is needed");
}

// The rename fails, at the very end: what was there stays, and nothing written aside is left lying about.
TEST(File, a_failed_write_leaves_nothing_behind) {
    const ScratchFolder folder;
    folder.file("taken/inside", "x");
    EXPECT_THAT(writeFile(folder / "taken", "y").error().message(),
                AllOf(StartsWith((folder / "taken").string()), HasSubstr("Is a directory")))
        << "a folder stands where the file should";
    EXPECT_THAT(folder.names(), ElementsAre("taken"));
    EXPECT_EQ(*readFile(folder / "taken/inside"), "x");
}

TEST(File, a_folder_that_cannot_be_made_is_named_with_the_reason) {
    const ScratchFolder folder;
    folder.file("file", "x");
    EXPECT_THAT(writeFile(folder / "file/below/a", "y").error().message(), HasSubstr("cannot be written: Not a directory"));
    EXPECT_THAT(writeFile("/proc/none/a", "y").error().message(), StartsWith("/proc/none/a: cannot be written: "))
        << "not even root may";
    EXPECT_THAT(folder.names(), ElementsAre("file"));
}

// Whoever has the old file open goes on reading the old bytes. Example failure: the file is truncated and written in place.
TEST(File, a_reader_never_sees_half_a_file) {
    const ScratchFolder folder;
    folder.file("a", "the old bytes");
    std::FILE* reader = std::fopen((folder / "a").c_str(), "rb");
    ASSERT_TRUE(writeFile(folder / "a", "new"));
    char bytes[100];
    EXPECT_EQ(std::string(bytes, std::fread(bytes, 1, sizeof bytes, reader)), "the old bytes");
    std::fclose(reader);
    EXPECT_EQ(*readFile(folder / "a"), "new");
}

}  // namespace
}  // namespace fantascope
