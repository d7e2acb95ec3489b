#pragma once
// A site of three projectors, no two alike, and a show with every kind of source and blend: what
// holds of these holds of any show.

#include "render/source/picture_source.h"
#include "show/cue_list.h"
#include "show/site/site.h"

#include "media/image.h"
#include "scratch_folder.h"

#include <glm/vec2.hpp>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::app {

struct ThreeOutputs {
    static constexpr glm::ivec2 kSize{320, 180};
    static constexpr double kRefreshRate = 60;
    static constexpr std::array<const char*, 3> kNames = {"left", "middle", "right"};

    // `displays`: the `display` of each output, as the site file has it.
    explicit ThreeOutputs(const std::array<std::string, 3>& displays);

    const ScratchFolder folder;
    show::Site site;
    render::PictureSources sources;
    std::shared_ptr<render::PictureFeed> camera;  // what one of them shows
    RgbaImage seen;                               // a picture for it
    show::CueList cues;                           // between them every source is on every output, in every blend
    int still = 0;                                // the cue in which nothing moves
};

}  // namespace fantascope::app
