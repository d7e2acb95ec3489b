#include "app/reload/file_watch.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Example failures: a file that is being written is read half; a file that was put in the place of
// another is not noticed.
TEST(FileWatch, finds_a_file_saved_once_it_stays_the_same) {
    const ScratchFolder folder;
    const auto show = folder.file("show.yaml", "1");
    FileWatch watch;
    watch.watch({show, folder / "none.png"});
    EXPECT_THAT(watch.saved(), IsEmpty());
    folder.file("show.yaml", "12");
    EXPECT_THAT(watch.saved(), IsEmpty()) << "it may be written still";
    folder.file("show.yaml", "123");
    EXPECT_THAT(watch.saved(), IsEmpty());
    EXPECT_THAT(watch.saved(), ElementsAre(show));
    EXPECT_THAT(watch.saved(), IsEmpty()) << "once";
    std::filesystem::remove(show);
    EXPECT_THAT(watch.saved(), IsEmpty());
    EXPECT_THAT(watch.saved(), IsEmpty()) << "an editor is about to put another in its place";
    std::filesystem::rename(folder.file("new.yaml", "1234"), show);
    EXPECT_THAT(watch.saved(), IsEmpty());
    EXPECT_THAT(watch.saved(), ElementsAre(show));
}

TEST(FileWatch, keeps_what_it_knows_of_a_file_that_it_goes_on_to_watch) {
    const ScratchFolder folder;
    const auto a = folder.file("a", "1"), b = folder.file("b", "1");
    FileWatch watch;
    watch.watch({a});
    folder.file("a", "12");
    watch.watch({a, b});
    watch.saved();
    EXPECT_THAT(watch.saved(), ElementsAre(a)) << "it was saved before the list changed";
    watch.watch({b});
    folder.file("a", "123");
    watch.saved();
    EXPECT_THAT(watch.saved(), IsEmpty());
}

}  // namespace
}  // namespace fantascope::app
