#include "contract/camera_source_suite.h"
#include "contract/simulated_rig.h"

#include <gmock/gmock.h>

#include <vector>

namespace fantascope::contract {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class SimulatedCameraRig final : public SimulatedRig<CameraSourceRig> {
public:
    explicit SimulatedCameraRig(Wrap<CameraSource> wrap = {}) : SimulatedRig("camera", std::move(wrap)) { reopen(); }

    void expose(int grey) override {
        const auto shade = static_cast<std::uint8_t>(grey);
        const CameraFrame frame{RgbaImage(4, 3, {shade, shade, shade, 255}), clock_.now(), sequence_++};
        world_.sendFromCamera(std::make_shared<const CameraFrame>(frame), clock_.now() + fromSeconds(0.05));
    }

private:
    std::unique_ptr<CameraSource> open() override { return drivers::openCamera(options_, context_).value(); }
    std::uint64_t sequence_ = 0;
};

template <class Broken>
std::vector<std::string> brokenBy() {
    return clausesOf(
        violations(cameraSourceSuite(), [] { return std::make_unique<SimulatedCameraRig>(wrappedIn<Broken, CameraSource>); }));
}

TEST(CameraSourceContract, is_kept_by_the_simulated_camera) {
    EXPECT_THAT(violations(cameraSourceSuite(), [] { return std::make_unique<SimulatedCameraRig>(); }), IsEmpty());
}

class BetweenCamera : public Between<CameraSource> {
public:
    using Between::Between;
    CameraDescription description() const override { return good_->description(); }
};

class RepeatsItsLastFrame : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        if (auto frame = good_->newest()) last_ = std::move(frame);
        return running() ? last_ : nullptr;
    }
    std::shared_ptr<const CameraFrame> last_;
};
// Otherwise the comparison with the guide would go on scoring an old picture.
TEST(CameraSourceContract, finds_a_camera_that_gives_a_frame_again) {
    EXPECT_THAT(
        brokenBy<RepeatsItsLastFrame>(),
        ElementsAre("without a new frame there is none", "of several frames the newest comes, and none of the older ones later"));
}

class GivesAStaleBufferAtItsReturn : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        const int losses = good_->status().losses;
        if (running() && std::exchange(seen_, losses) != losses)
            return std::make_shared<const CameraFrame>(CameraFrame{RgbaImage(4, 3), {}, 0});
        return good_->newest();
    }
    int seen_ = 0;
};
TEST(CameraSourceContract, finds_a_camera_that_comes_back_with_an_old_picture) {
    EXPECT_THAT(brokenBy<GivesAStaleBufferAtItsReturn>(),
                testing::Contains("a lost camera gives nothing, and after its return nothing from before"));
}

class ReusesOneBuffer : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        const auto frame = good_->newest();
        if (!frame) return nullptr;
        *buffer_ = *frame;
        return buffer_;
    }
    std::shared_ptr<CameraFrame> buffer_ = std::make_shared<CameraFrame>();
};
TEST(CameraSourceContract, finds_a_camera_that_overwrites_a_frame_in_use) {
    EXPECT_THAT(brokenBy<ReusesOneBuffer>(), testing::Contains("a frame that is held stays as it was while others come"));
}

class GivesTheTimeOfTaking : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        const auto frame = good_->newest();
        if (!frame) return nullptr;
        CameraFrame late = *frame;
        late.exposed = context_.clock.now();
        return std::make_shared<const CameraFrame>(std::move(late));
    }
};
// Otherwise latency would look like a projector that lags behind the show.
TEST(CameraSourceContract, finds_a_camera_that_takes_the_arrival_for_the_exposure) {
    EXPECT_THAT(brokenBy<GivesTheTimeOfTaking>(),
                ElementsAre("a frame tells when it was exposed, and both its time and its count rise"));
}

class CountsAnewAfterALoss : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        const auto frame = good_->newest();
        if (!frame) return nullptr;
        if (const int losses = good_->status().losses; std::exchange(losses_, losses) != losses) first_ = frame->sequence;
        CameraFrame counted = *frame;
        counted.sequence -= first_;
        return std::make_shared<const CameraFrame>(std::move(counted));
    }
    int losses_ = 0;
    std::uint64_t first_ = 0;
};
// As every kernel driver does. A search for gaps would then find false ones, or none.
TEST(CameraSourceContract, finds_a_camera_that_counts_anew_after_a_loss) {
    EXPECT_THAT(brokenBy<CountsAnewAfterALoss>(), ElementsAre("its count and its times go on rising after a loss"));
}

class LeavesAlphaOpen : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override {
        const auto frame = good_->newest();
        if (!frame) return nullptr;
        CameraFrame clear = *frame;
        for (Rgba8& pixel : clear.image.pixels()) pixel.a = 0;
        return std::make_shared<const CameraFrame>(std::move(clear));
    }
};
TEST(CameraSourceContract, finds_a_camera_whose_frames_are_transparent) {
    EXPECT_THAT(brokenBy<LeavesAlphaOpen>(), testing::Contains("a frame comes once, with what was seen"));
}

class ForgetsWhatItIs : public BetweenCamera {
    using BetweenCamera::BetweenCamera;
    std::shared_ptr<const CameraFrame> newest() override { return good_->newest(); }
    CameraDescription description() const override { return running() ? good_->description() : CameraDescription(); }
};
// A lens is kept by what the camera says of itself.
TEST(CameraSourceContract, finds_a_camera_that_forgets_what_it_is) {
    EXPECT_THAT(brokenBy<ForgetsWhatItIs>(), ElementsAre("it says what it is, and still does when it is lost"));
}

}  // namespace
}  // namespace fantascope::contract
