#include "render/gpu/paint/convolution.h"

#include "render/canvas/fourier_plan.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace fantascope::render::gpu {
namespace {

// Bindings of assets/shaders/coverage.comp.
constexpr GLuint kPainted = 0;   // texture
constexpr GLuint kCoverage = 0;  // image

// Bindings of assets/shaders/convolve.comp.
constexpr const char* kShader = "convolve.comp";
constexpr GLint kAlong = 0, kSpan = 1, kCount = 2, kQuarter = 3, kMargin = 4, kFromCoverage = 5;
constexpr GLuint kField = 0, kBlurred = 1;     // images
constexpr GLuint kPicture = 0, kSpectrum = 0;  // textures, of different passes
constexpr unsigned kTogether = 32;             // butterflies per work group, side by side

void store(const Texture& texture, GLenum format, glm::ivec2 size) {
    glTextureStorage2D(texture.name(), 1, format, size.x, size.y);
    glTextureParameteri(texture.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

Result<Convolution> Convolution::create(glm::ivec2 size, const GreyImage& filter, int block, int samples,
                                        ProgramCache& programs) {
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(size.x, size.y) > largest)
        return Error(fmt::format("{} x {} pixels: OpenGL blurs at most {} per dimension here", size.x, size.y, largest));

    Convolution made(size, glm::ivec2(filter.width(), filter.height()) / 2);
    const glm::ivec2 quarterAndMargin = made.quarter_ + 2 * made.margin_;
    const FourierPlan rows(quarterAndMargin.x), columns(quarterAndMargin.y);
    const glm::ivec2 field(rows.length(), columns.length());
    store(made.coverage_, GL_R32F, made.whole_);
    store(made.field_, GL_RGBA32F, field);
    store(made.blurred_, GL_R32F, size);
    store(made.spectrum_, GL_RG32F, field);
    const auto spectrum = filterSpectrum(filter, rows, columns);
    glTextureSubImage2D(made.spectrum_.name(), 0, 0, 0, field.x, field.y, GL_RG, GL_FLOAT, spectrum.data());

    // Rows, columns, and back in reverse order. The last forward pass over the columns is also the
    // first one back.
    const auto add = [&](bool inRows, std::size_t number, const std::string& kind) -> Result<void> {
        const FourierPlan& plan = inRows ? rows : columns;
        const int radix = plan.radices()[number];
        int span = plan.length();
        for (std::size_t before = 0; before < number; ++before) span /= plan.radices()[before];
        const unsigned program = TRY(programs.compute(kShader, fmt::format("#define RADIX {}\n{}", radix, kind)));
        const int butterflies = plan.length() / radix;
        made.passes_.push_back({program, inRows ? glm::ivec2(1, 0) : glm::ivec2(0, 1), span,
                                inRows ? glm::ivec2(butterflies, field.y) : glm::ivec2(field.x, butterflies)});
        return {};
    };
    const std::size_t inRows = rows.radices().size(), inColumns = columns.radices().size();
    made.cover_ = TRY(programs.compute("coverage.comp", fmt::format("#define BLOCK {}\n#define SAMPLES {}\n", block, samples)));
    for (std::size_t i = 0; i < inRows; ++i) TRY(add(true, i, i == 0 ? "#define SOURCE\n" : ""));
    for (std::size_t i = 0; i + 1 < inColumns; ++i) TRY(add(false, i, ""));
    TRY(add(false, inColumns - 1, "#define FILTER\n"));
    for (std::size_t i = inColumns - 1; i-- > 0;) TRY(add(false, i, "#define INVERSE\n"));
    for (std::size_t i = inRows; i-- > 0;) TRY(add(true, i, i == 0 ? "#define INVERSE\n#define SINK\n" : "#define INVERSE\n"));
    return made;
}

void Convolution::run(const LayerPicture& painted, glm::vec2 fromCoverage) {
    const auto dispatch = [](unsigned columns, unsigned rows) {
        glDispatchCompute((columns + kTogether - 1) / kTogether, rows, 1);
        glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    };
    glUseProgram(cover_);
    glBindTextureUnit(kPainted, painted.texture());
    glBindImageTexture(kCoverage, coverage_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    dispatch(static_cast<unsigned>(whole_.x), static_cast<unsigned>(whole_.y));

    glBindImageTexture(kField, field_.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32F);
    glBindImageTexture(kBlurred, blurred_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glBindTextureUnit(kPicture, coverage_.name());
    for (std::size_t i = 0; i < passes_.size(); ++i) {
        const Pass& pass = passes_[i];
        if (i == 1) glBindTextureUnit(kSpectrum, spectrum_.name());
        glUseProgram(pass.program);
        glUniform2i(kAlong, pass.along.x, pass.along.y);
        glUniform1i(kSpan, pass.span);
        glUniform2i(kCount, pass.count.x, pass.count.y);
        glUniform2i(kQuarter, quarter_.x, quarter_.y);
        if (i + 1 == passes_.size()) {
            glUniform2i(kMargin, margin_.x, margin_.y);
            glUniform2f(kFromCoverage, fromCoverage.x, fromCoverage.y);
        }
        dispatch(static_cast<unsigned>(pass.count.x), static_cast<unsigned>(pass.count.y));
    }
}

}  // namespace fantascope::render::gpu
