#include "core/file.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <utility>

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

std::filesystem::perms permissions(const std::filesystem::path& file) { return std::filesystem::status(file).permissions(); }

TEST(File, permissions_and_links_stay_as_they_are) {
    using std::filesystem::perms;
    const ScratchFolder folder;
    folder.file("deep/a", "old");
    std::filesystem::permissions(folder / "deep/a", perms::owner_read | perms::owner_write | perms::group_write);
    std::filesystem::create_symlink("deep/a", folder / "link");
    ASSERT_TRUE(writeFile(folder / "link", "new"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_EQ(*readFile(folder / "deep/a"), "new");
    EXPECT_EQ(permissions(folder / "deep/a"), perms::owner_read | perms::owner_write | perms::group_write);

    ASSERT_TRUE(writeFile(folder / "b", "x"));
    EXPECT_EQ(permissions(folder / "b"), perms(0644));
    ASSERT_TRUE(writeFile(folder / "c", "x", folder / "deep/a"));
    EXPECT_EQ(permissions(folder / "c"), permissions(folder / "deep/a"));

    std::filesystem::create_symlink("nowhere", folder / "broken");
    EXPECT_THAT(writeFile(folder / "broken", "x").error().message(), HasSubstr("cannot be written: No such file"));
    EXPECT_THAT(folder.names(), ElementsAre("b", "broken", "c", "deep", "link"));
}

// Only root may give files away; others can test this only with their own files.
TEST(File, the_owner_stays) {
    const bool root = ::geteuid() == 0;
    const uid_t owner = root ? 1234 : ::geteuid();
    const gid_t group = root ? 2345 : ::getegid();
    const ScratchFolder folder;
    folder.file("a", "old");
    ASSERT_EQ(::chown((folder / "a").c_str(), owner, group), 0);
    ASSERT_TRUE(writeFile(folder / "a", "new"));
    ASSERT_TRUE(writeFile(folder / "b", "x", folder / "a"));
    for (const char* name : {"a", "b"}) {
        struct stat status = {};
        ASSERT_EQ(::stat((folder / name).c_str(), &status), 0);
        EXPECT_EQ(status.st_uid, owner) << name;
        EXPECT_EQ(status.st_gid, group) << name;
    }
}

TEST(File, a_file_that_is_kept_from_being_written_is_not_replaced) {
    const ScratchFolder folder;
    folder.file("a", "old");
    std::filesystem::permissions(folder / "a", std::filesystem::perms(0444));
    EXPECT_EQ(writeFile(folder / "a", "new").error().message(),
              (folder / "a").string() + ": cannot be written: Permission denied");
    EXPECT_EQ(*readFile(folder / "a"), "old");
    EXPECT_THAT(folder.names(), ElementsAre("a"));
}

// As on a full disk: some bytes are already in the temporary file. Example failure: the
// half-written file stays, or replaces the old one.
TEST(File, two_files_are_swapped_through_links) {
    const ScratchFolder folder;
    folder.file("a", "one");
    folder.file("b", "other");
    std::filesystem::create_symlink("a", folder / "link");
    ASSERT_TRUE(exchangeFiles(folder / "link", folder / "b"));
    EXPECT_EQ(*readFile(folder / "a"), "other");
    EXPECT_EQ(*readFile(folder / "b"), "one");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
}

// Another file system, so they cannot be swapped in one step.
TEST(File, two_files_of_two_file_systems_are_swapped_too) {
    const ScratchFolder folder;
    const std::filesystem::path far = "/dev/shm/fantascope-" + std::to_string(::getpid());
    ASSERT_TRUE(writeFile(far, "far"));
    std::filesystem::create_symlink(far, folder / "link");
    ASSERT_TRUE(exchangeFiles(folder.file("near", "near"), folder / "link"));
    EXPECT_EQ(*readFile(folder / "near"), "far");
    EXPECT_EQ(*readFile(far), "near");
    std::filesystem::remove(far);
}

TEST(File, a_file_that_is_kept_from_being_written_is_not_swapped) {
    const ScratchFolder folder;
    std::filesystem::permissions(folder.file("a", "one"), std::filesystem::perms::owner_read);
    EXPECT_EQ(exchangeFiles(folder.file("b", "other"), folder / "a").error().message(),
              (folder / "a").string() + ": cannot be written: Permission denied");
    EXPECT_FALSE(exchangeFiles(folder / "b", folder / "none"));
    EXPECT_EQ(*readFile(folder / "a") + *readFile(folder / "b"), "oneother");
    EXPECT_THAT(folder.names(), ElementsAre("a", "b"));
}

TEST(File, a_write_that_fails_half_way_leaves_the_old_bytes) {
    const ScratchFolder folder;
    folder.file("a", "old");
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limited = {1000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limited), 0);
    const auto written = writeFile(folder / "a", std::string(5000, 'x'));
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(written.error().message(), (folder / "a").string() + ": cannot be written: File too large");
    EXPECT_EQ(*readFile(folder / "a"), "old");
    EXPECT_THAT(folder.names(), ElementsAre("a"));
}

// Example failures: waiting for a pipe forever; reading an endless device until memory is full.
TEST(File, what_is_no_regular_file_is_refused_at_once) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::filesystem::create_symlink("pipe", folder / "link");
    const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    (folder / "socket").string().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    const std::pair<std::filesystem::path, const char*> kinds[] = {{folder / "pipe", "pipe"},
                                                                   {folder / "link", "pipe"},
                                                                   {folder / "socket", "socket"},
                                                                   {"/dev/zero", "device"},
                                                                   {"/tmp", "folder"}};
    for (const auto& [path, kind] : kinds) {
        const std::string wanted = fmt::format("{}: is a {}, a file is needed", path.string(), kind);
        EXPECT_EQ(readFile(path).error().message(), wanted);
        EXPECT_EQ(readStart(path, 10).error().message(), wanted);
        EXPECT_EQ(checkRegular(path).error().message(), wanted);
    }
    ::close(listening);
    EXPECT_TRUE(checkRegular(folder / "none")) << "who opens it will say so";
}

TEST(File, that_is_too_large_is_refused_before_it_is_read) {
    const ScratchFolder folder;
    const auto file = folder.file("a", "");
    std::filesystem::resize_file(file, 100'000);
    EXPECT_EQ(readFile(file, 100'000)->size(), 100'000u);
    std::filesystem::resize_file(file, std::uintmax_t{1} << 40);  // a sparse terabyte
    EXPECT_THAT(folder.relative(readFile(file).error().message()),
                "a: is too large, 1048576.0 MiB: such a file has at most 32 MiB; make it smaller, or name another");
    EXPECT_EQ(readStart(file, 5)->size(), 5u);
}

// A program that is killed leaves no half-written file. Example failure: NAME.part is left over.
TEST(File, that_is_written_has_no_name_before_it_is_whole) {
    const ScratchFolder folder;
    for (const char* before : {"", "old"}) {
        const std::string name = *before != '\0' ? "a" : "b";
        if (*before != '\0') folder.file(name, before);
        const auto names = folder.names();
        {
            auto file = NewFile::open(folder / name);
            ASSERT_TRUE(file && file->write("new"));
            EXPECT_EQ(folder.names(), names);
        }
        EXPECT_EQ(folder.names(), names) << "without finish() nothing was written";
        auto file = NewFile::open(folder / name);
        ASSERT_TRUE(file && file->write("new") && file->finish());
        EXPECT_EQ(*readFile(folder / name), "new");
    }
    EXPECT_THAT(folder.names(), ElementsAre("a", "b"));
}

// Example failure: a report written to /dev/null replaces it, for every program on the machine.
TEST(File, a_device_is_not_replaced) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(folder.relative(writeFile(folder / "pipe", "x").error().message()),
              "pipe: cannot be written: it is a device or a pipe, a file is needed");
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
}

// The rename fails at the very end: the old file stays, and no temporary file is left over.
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

// A reader that has the old file open goes on reading the old bytes. Example failure: the file is
// truncated and written in place.
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
