#pragma once

#include "device/camera_source.h"

#include "contract/rig.h"

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

namespace fantascope::contract {

class CameraSourceRig : public Rig<CameraSource> {
public:
    // The camera exposes a frame now, all of it of one grey. Greys 16 apart must be
    // distinguishable, so that a rig may compress.
    virtual void expose(int grey) = 0;
};

inline std::string differs(const std::shared_ptr<const CameraFrame>& frame, int grey) {
    CONTRACT_REQUIRE(frame != nullptr, "no frame came, one of grey {} was exposed", grey);
    CONTRACT_REQUIRE(!frame->image.empty(), "the frame has no pixels");
    for (const Rgba8 pixel : frame->image.pixels())
        CONTRACT_REQUIRE(std::abs(pixel.r - grey) < 8 && pixel.a == 255, "a pixel is {} with alpha {}, not {} with 255", pixel.r,
                         pixel.a, grey);
    return "";
}

// Every promise of device/camera_source.h.
inline Suite<CameraSourceRig> cameraSourceSuite() {
    const auto serves = [](CameraSourceRig& rig) -> std::string {
        for (const int grey : {40, 200}) {
            rig.expose(grey);
            rig.letTimePass();
            if (auto wrong = differs(rig.port().newest(), grey); !wrong.empty()) return wrong;
        }
        return "";
    };
    return joined<CameraSourceRig>(lifeClauses<CameraSourceRig>(serves),
                                   {
                                       {"a frame comes once, with what was seen", serves},
                                       {"it says what it is, and still does when it is lost",
                                        [serves](CameraSourceRig& rig) -> std::string {
                                            if (auto wrong = serves(rig); !wrong.empty()) return wrong;
                                            const CameraDescription before = rig.port().description();
                                            CONTRACT_REQUIRE(!before.card.empty(), "a camera that works has no name");
                                            rig.unplug();
                                            rig.letTimePass();
                                            CONTRACT_REQUIRE(rig.port().description() == before, "it forgot what it was");
                                            return "";
                                        }},
                                       {"without a new frame there is none",
                                        [](CameraSourceRig& rig) -> std::string {
                                            CONTRACT_REQUIRE(rig.port().newest() == nullptr, "a frame before the first exposure");
                                            rig.expose(100);
                                            rig.letTimePass();
                                            CONTRACT_REQUIRE(rig.port().newest() != nullptr, "no frame came");
                                            CONTRACT_REQUIRE(rig.port().newest() == nullptr, "the same frame came twice");
                                            return "";
                                        }},
                                       {"of several frames the newest comes, and none of the older ones later",
                                        [](CameraSourceRig& rig) -> std::string {
                                            for (const int grey : {30, 60, 90}) {
                                                rig.expose(grey);
                                                rig.letTimePass();
                                            }
                                            if (auto wrong = differs(rig.port().newest(), 90); !wrong.empty()) return wrong;
                                            CONTRACT_REQUIRE(rig.port().newest() == nullptr, "an older frame came after it");
                                            return "";
                                        }},
                                       {"a frame tells when it was exposed, and both its time and its count rise",
                                        [](CameraSourceRig& rig) -> std::string {
                                            std::shared_ptr<const CameraFrame> last;
                                            for (int i = 0; i < 3; ++i) {
                                                rig.letTimePass();
                                                const Time before = rig.clock().now();
                                                rig.expose(50 + 20 * i);
                                                const Time after = rig.clock().now();
                                                rig.letTimePass();
                                                auto frame = rig.port().newest();
                                                CONTRACT_REQUIRE(frame != nullptr, "no frame came");
                                                CONTRACT_REQUIRE(before <= frame->exposed && frame->exposed <= after,
                                                                 "exposed at {} s, really at {} s", seconds(frame->exposed),
                                                                 seconds(before));
                                                CONTRACT_REQUIRE(!last || frame->sequence > last->sequence, "count {} after {}",
                                                                 frame->sequence, last->sequence);
                                                last = std::move(frame);
                                            }
                                            return "";
                                        }},
                                       {"its count and its times go on rising after a loss",
                                        [](CameraSourceRig& rig) -> std::string {
                                            std::shared_ptr<const CameraFrame> last;
                                            for (int life = 0; life < 2; ++life) {
                                                for (int i = 0; i < 3; ++i) {
                                                    rig.expose(100);
                                                    rig.letTimePass();
                                                    auto frame = rig.port().newest();
                                                    CONTRACT_REQUIRE(frame != nullptr, "no frame came");
                                                    CONTRACT_REQUIRE(!last || frame->sequence > last->sequence,
                                                                     "count {} after {}", frame->sequence, last->sequence);
                                                    CONTRACT_REQUIRE(!last || frame->exposed > last->exposed, "{} s after {} s",
                                                                     seconds(frame->exposed), seconds(last->exposed));
                                                    last = std::move(frame);
                                                }
                                                rig.lose();
                                                rig.giveBack();
                                            }
                                            return "";
                                        }},
                                       {"a frame that is held stays as it was while others come",
                                        [](CameraSourceRig& rig) -> std::string {
                                            rig.expose(80);
                                            rig.letTimePass();
                                            const auto held = rig.port().newest();
                                            for (int i = 0; i < 4; ++i) {
                                                rig.expose(120 + 20 * i);
                                                rig.letTimePass();
                                                (void)rig.port().newest();
                                            }
                                            return differs(held, 80);
                                        }},
                                       {"a lost camera gives nothing, and after its return nothing from before",
                                        [](CameraSourceRig& rig) -> std::string {
                                            rig.expose(100);  // nobody takes it before the loss
                                            rig.lose();
                                            CONTRACT_REQUIRE(rig.port().newest() == nullptr, "a frame while it is lost");
                                            rig.giveBack();
                                            CONTRACT_REQUIRE(rig.port().newest() == nullptr, "a frame from before the loss");
                                            rig.expose(160);
                                            rig.letTimePass();
                                            return differs(rig.port().newest(), 160);
                                        }},
                                   });
}

}  // namespace fantascope::contract
