#pragma once

#include "render/canvas/blend_map.h"
#include "render/gpu/handles.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/program_cache.h"
#include "show/show_state.h"

#include "core/result.h"
#include "media/projection.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace fantascope::render::gpu {

// Composes painted layers into what one projector is sent: their samples are averaged as light,
// layers blend in their order, and the sum passes the projector's colours, the blend with its
// neighbours, its gamma and the dither once a pixel.
//
// A frame: begin(); for each layer from the bottom paint nextPicture() and lay() it; endPicture()
// after each picture's last; finish().
// Thread: the context's.
class Composer {
public:
    // As many layers as one pass over the picture takes: in a crossfade there are two.
    static constexpr std::size_t kTogether = 2;

    // `size`: pixels of the projector; `samples`: a pixel, at least. `programs` outlives it. Error:
    // more pixels or samples than this OpenGL has.
    static Result<Composer> create(glm::ivec2 size, int samples, ProgramCache& programs);

    int samples() const { return pictures_[0].samples(); }
    // The projector's colours from now on, and what it gives to each pixel beside its neighbours
    // (null: all of its light). Compiles what was not needed before. Error: a shader does not
    // compile.
    Result<void> follow(const ProjectorLight& light, const std::shared_ptr<const BlendMap>& blend);

    void begin();
    // Where the next layer is to be painted.
    LayerPicture& nextPicture();
    // What was painted there lies on top of the picture so far.
    void lay(float opacity, show::Blend blend);
    // The layers so far are one picture, whose light counts with this weight; what follows begins
    // another.
    void endPicture(float weight);
    // Into the display's framebuffer of stored values.
    void finish(unsigned framebuffer);
    // Runs every pass that a frame could need, so that none is compiled while people watch.
    void warmUp(unsigned framebuffer);

private:
    struct Layer {
        glm::vec3 blend{0};  // assets/shaders/compose.frag says how these are used
        glm::vec2 turn{0, 1};
    };
    // What the layers before those of one pass have come to: the sum of the pictures that ended,
    // and the one that did not.
    struct Carried {
        explicit Carried(glm::ivec2 size);
        Texture sum, picture;
        Framebuffer framebuffer;
    };
    struct Finishing {  // what is needed besides the sum
        bool tint = false, cube = false, blend = false, encode = false, dither = false;
    };
    enum class End { Carry, Finish };

    Composer(glm::ivec2 size, std::array<LayerPicture, kTogether> pictures, ProgramCache& programs)
        : size_(size), pictures_(std::move(pictures)), programs_(&programs) {}
    Result<unsigned> programFor(std::size_t layers, bool carries, End end) const;
    void pass(End end, unsigned framebuffer);
    void bringCube();
    void bringBlendMap();

    glm::ivec2 size_;
    std::array<LayerPicture, kTogether> pictures_;
    ProgramCache* programs_;
    VertexArray noVertices_;

    Finishing finishing_;
    glm::vec3 tint_{1};
    std::array<glm::vec3, 2> cubeFrom_{};
    float gamma_ = 0;
    // What was brought to the GPU, and as what; null: nothing.
    std::shared_ptr<const ColourCube> cubeThere_;
    std::optional<Texture3> cube_;
    std::shared_ptr<const BlendMap> blendThere_;
    std::optional<Texture> blendMap_;
    std::array<std::array<std::array<unsigned, 2>, 2>, kTogether + 1> passes_{};  // programs: [layers][carries][end]

    // The frame that is being made.
    std::array<Layer, kTogether> layers_;
    std::size_t count_ = 0;                            // of the layers that wait for their pass
    bool carries_ = false;                             // there was a pass already
    float weight_ = 0;                                 // of the picture that ended last
    bool fresh_ = true;                                // the next layer begins a picture
    std::array<std::unique_ptr<Carried>, 2> carried_;  // made when first needed, written in turn
    std::size_t newest_ = 0;                           // of carried_
};

}  // namespace fantascope::render::gpu
