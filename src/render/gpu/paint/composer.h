#pragma once

#include "render/canvas/blend_map.h"
#include "render/gpu/handles.h"
#include "render/gpu/layer_picture.h"
#include "render/gpu/program_cache.h"
#include "show/show_state.h"

#include "core/geometry.h"
#include "core/result.h"
#include "media/image.h"
#include "media/projection.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

namespace fantascope::render::gpu {

// Composes painted layers into the picture for one projector. Samples are averaged in linear light,
// and layers blend in their order. The result then passes the projector's colours, the light
// correction, the blend with its neighbours, its gamma and the dither, once per pixel.
//
// For each frame call: begin(); for each layer from the bottom up, paint nextPicture() and lay()
// it; endPicture() after the last layer of each picture; finish().
// Thread: the context's.
class Composer {
public:
    // The maximum number of layers per pass. A crossfade has two.
    static constexpr std::size_t kTogether = 2;

    // `size`: pixels of the projector. `samples`: minimum per pixel. `programs` outlives it.
    // `gain`: the light correction, a factor of linear light for each pixel of the projector; null:
    // none. Error: more pixels or samples than OpenGL allows here.
    static Result<Composer> create(glm::ivec2 size, int samples, ProgramCache& programs, const GreyImage* gain = nullptr);

    int samples() const { return pictures_[0].samples(); }
    // Sets the projector's colours and its share of the light beside its neighbours (null: all of
    // it). Compiles programs that were not needed before. Error: a shader does not compile.
    Result<void> follow(const ProjectorLight& light, const std::shared_ptr<const BlendMap>& blend);

    // How far the light correction is faded in from now on, 0..1.
    void correctLight(float share) { gainShare_ = share; }
    // Blend map and light correction belong to places on the wall. `moved`: where the projector
    // pixels that lit these places are now; nothing: where they were.
    void moveMaps(const std::optional<Homography>& moved);

    void begin();
    // The picture into which the next layer is to be painted.
    LayerPicture& nextPicture();
    // Blends the layer painted there over the picture so far.
    void lay(float opacity, show::Blend blend);
    // Ends a picture, whose light counts with this weight. The next layer begins another one.
    void endPicture(float weight);
    // Writes the result into the display's framebuffer, as stored values.
    void finish(unsigned framebuffer);
    // Runs every pass that a frame could need, so that none is compiled during the show.
    void warmUp(unsigned framebuffer);

private:
    struct Layer {
        glm::vec3 blend{0};  // assets/shaders/compose.frag says how these are used
        glm::vec2 turn{0, 1};
    };
    // The result of earlier passes: the sum of the pictures that have ended, and the picture that
    // has not.
    struct Carried {
        explicit Carried(glm::ivec2 size);
        Texture sum, picture;
        Framebuffer framebuffer;
    };
    struct Finishing {  // the steps after the sum that are needed
        bool tint = false, cube = false, gain = false, blend = false, encode = false, dither = false;
    };
    enum class End { Carry, Finish };

    Composer(glm::ivec2 size, std::array<LayerPicture, kTogether> pictures, ProgramCache& programs)
        : size_(size), pictures_(std::move(pictures)), programs_(&programs) {}
    Result<unsigned> programFor(std::size_t layers, bool carries, End end) const;
    void pass(End end, unsigned framebuffer);
    void uploadCube();
    void uploadBlendMap();
    void uploadGain(const GreyImage& gain);

    glm::ivec2 size_;
    std::array<LayerPicture, kTogether> pictures_;
    ProgramCache* programs_;
    VertexArray noVertices_;

    Finishing finishing_;
    glm::vec3 tint_{1};
    std::array<glm::vec3, 2> cubeFrom_{};
    float gamma_ = 0;
    float gainShare_ = 1;
    glm::mat3 onMaps_{0.0f};
    std::optional<Texture> gainMap_;
    // What has been uploaded; null: nothing.
    std::shared_ptr<const ColourCube> uploadedCube_;
    std::optional<Texture3> cube_;
    std::shared_ptr<const BlendMap> uploadedBlend_;
    std::optional<Texture> blendMap_;
    std::array<std::array<std::array<unsigned, 2>, 2>, kTogether + 1> passes_{};  // programs: [layers][carries][end]

    // The current frame.
    std::array<Layer, kTogether> layers_;
    std::size_t count_ = 0;                            // of layers that wait for their pass
    bool carries_ = false;                             // there was a pass before
    float weight_ = 0;                                 // of the last picture that ended
    bool fresh_ = true;                                // the next layer begins a picture
    std::array<std::unique_ptr<Carried>, 2> carried_;  // made when first needed, written alternately
    std::size_t newest_ = 0;                           // of carried_
};

}  // namespace fantascope::render::gpu
