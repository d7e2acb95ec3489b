#include "app/live/screenshots.h"

#include "app/live/frame_loop.h"
#include "app/running_show.h"

#include "media/image.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The default show on its two outputs, its sources one grey each, frame by frame.
class ScreenshotsTest : public testing::Test {
protected:
    ScreenshotsTest() {
        const auto sources = render::PictureSources::numbered({run_.show.sources.size(), render::SolidSource{}});
        loop_.emplace(run_.site, run_.inputs, sources, sourceFolder() + "/assets", run_.devices, run_.clock);
        std::vector<std::string> names;
        std::vector<render::NewestFrame*> frames;
        for (std::size_t output = 0; output < 2; ++output) {
            names.push_back(run_.site.outputs[output].name);
            frames.push_back(&loop_->tap(output).addNewest(0));
            all_.push_back(&loop_->tap(output).addQueue());
        }
        EXPECT_TRUE(loop_->prepare());
        start_ = run_.clock.now();
        loop_->begin(show::ShowClock(start_));
        screenshots_.emplace(folder_ / "pictures", run_.played, run_.inputs, names, frames, show::ShowClock(start_), run_.events);
    }
    void play(Time length) {
        for (const Time end = run_.clock.now() + length; run_.clock.now() < end;) {
            loop_->step();
            for (std::size_t output = 0; output < 2; ++output)
                while (const render::ShownFrame* const frame = all_[output]->next(Time::max()))
                    shown_[{frame->showTime, output}] = frame->image;
            screenshots_->tick(run_.clock.now());
        }
    }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        if (std::filesystem::exists(folder_ / "pictures"))
            for (const auto& entry : std::filesystem::directory_iterator(folder_ / "pictures"))
                names.push_back(entry.path().filename());
        std::ranges::sort(names);
        return names;
    }

    const ScratchFolder folder_;
    RunningShow run_;
    std::optional<FrameLoop> loop_;
    std::vector<render::FrameReader*> all_;
    std::optional<Screenshots> screenshots_;
    Time start_{};
    std::map<std::pair<Time, std::size_t>, RgbaImage> shown_;  // every frame
};

// Example failure: the outputs are pictures of two moments, or of a cue that came later than the
// frame.
TEST_F(ScreenshotsTest, every_output_at_one_moment_as_its_display_got_it_and_named_after_the_cue) {
    play(200ms);
    EXPECT_THAT(files(), IsEmpty()) << "nobody asked";
    run_.inputs.submit(run_.jumpTo("First light"));
    play(1s);
    screenshots_->take();
    play(500ms);
    const std::vector<std::string> names = files();
    ASSERT_THAT(names, ElementsAre(HasSubstr("s-2-First-light-left.png"), HasSubstr("s-2-First-light-right.png")));
    EXPECT_EQ(names[0].substr(0, 10), names[1].substr(0, 10));
    const Time moment = fromSeconds(std::stod(names[0]));
    EXPECT_GT(moment, 1200ms);
    EXPECT_LT(moment, 1500ms);
    for (std::size_t output = 0; output < 2; ++output) {
        const auto picture = readRgba(folder_ / "pictures" / names[output]);
        ASSERT_TRUE(picture);
        // The file's name has milliseconds.
        const auto frame = std::ranges::find_if(shown_, [&](const auto& entry) {
            return entry.first.second == output && std::chrono::abs(entry.first.first - moment) <= 500us;
        });
        ASSERT_NE(frame, shown_.end());
        EXPECT_EQ(*picture, frame->second) << names[output];
    }
    EXPECT_THAT(run_.told(), ElementsAre(AllOf(HasSubstr("picture: "), HasSubstr((folder_ / "pictures" / names[0]).string())),
                                         HasSubstr((folder_ / "pictures" / names[1]).string())));
    play(1s);
    EXPECT_EQ(files().size(), 2u) << "one picture a press";
}

TEST_F(ScreenshotsTest, says_which_output_shows_nothing_and_takes_the_others) {
    play(200ms);
    run_.world.setPlugged("left", false);
    screenshots_->take();
    play(4s);
    EXPECT_THAT(files(), ElementsAre(HasSubstr("s-before-the-first-cue-right.png")));
    EXPECT_THAT(run_.told(), ElementsAre(HasSubstr("right.png"), AllOf(HasSubstr("no picture"), HasSubstr("'left'"))));
    run_.world.setPlugged("left", true);
    play(500ms);
    EXPECT_EQ(files().size(), 1u) << "what was given up does not come later";
    screenshots_->take();
    play(500ms);
    EXPECT_EQ(files().size(), 3u);
}

TEST_F(ScreenshotsTest, says_why_a_picture_cannot_be_written_and_the_show_goes_on) {
    folder_.file("pictures", "a file, no folder");
    screenshots_->take();
    play(500ms);
    EXPECT_THAT(run_.told(), ElementsAre(HasSubstr("no picture: "), HasSubstr("no picture: ")));
    EXPECT_EQ(loop_->framesLate(), 0);
}

}  // namespace
}  // namespace fantascope::app
