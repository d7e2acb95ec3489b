#include "app/parts/part.h"

#include "render/gpu/shader_program.h"

#include "core/check.h"
#include "outputs.h"
#include "source_folder.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace fantascope::render {
namespace {

const std::filesystem::path kFolder = sourceFolder() + "/bench";

// The plain draw on one output. The output's context is current in every call.
class Floor {
public:
    Floor(const PatternSource& source, glm::ivec2 size, int samples)
        : source_(source), size_(size), poses_(source.pattern->instances.size()) {
        const TriangleMesh& mesh = source.pattern->shapes[0].mesh;
        indices_ = static_cast<GLsizei>(3 * mesh.triangles.size());
        instances_.resize(poses_.size());
        const auto bytes = [](const auto& all) { return static_cast<GLsizeiptr>(all.size() * sizeof(all[0])); };
        std::array<GLuint, 3> buffers{};
        glCreateBuffers(3, buffers.data());
        glNamedBufferStorage(buffers[0], bytes(mesh.vertices), mesh.vertices.data(), 0);
        glNamedBufferStorage(buffers[1], bytes(mesh.triangles), mesh.triangles.data(), 0);
        perInstance_ = buffers[2];
        glNamedBufferData(perInstance_, bytes(instances_), nullptr, GL_STREAM_DRAW);
        glCreateVertexArrays(1, &array_);
        glVertexArrayElementBuffer(array_, buffers[1]);
        glVertexArrayVertexBuffer(array_, 0, buffers[0], 0, sizeof(glm::vec3));
        glVertexArrayVertexBuffer(array_, 1, perInstance_, 0, sizeof(Instance));
        glVertexArrayBindingDivisor(array_, 1, 1);
        const auto attribute = [&](GLuint binding, GLuint location, GLint components, std::size_t offset) {
            glEnableVertexArrayAttrib(array_, location);
            glVertexArrayAttribFormat(array_, location, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
            glVertexArrayAttribBinding(array_, location, binding);
        };
        attribute(0, 0, 3, 0);
        for (GLuint column = 0; column < 4; ++column) attribute(1, 1 + column, 4, column * sizeof(glm::vec4));
        attribute(1, 5, 3, offsetof(Instance, colour));

        std::array<GLuint, 2> planes{};
        glCreateRenderbuffers(2, planes.data());
        glNamedRenderbufferStorageMultisample(planes[0], samples, GL_SRGB8_ALPHA8, size.x, size.y);
        glNamedRenderbufferStorageMultisample(planes[1], samples, GL_DEPTH_COMPONENT24, size.x, size.y);
        glCreateFramebuffers(1, &framebuffer_);
        glNamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, planes[0]);
        glNamedFramebufferRenderbuffer(framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, planes[1]);
    }

    // Draws a frame and resolves it into the framebuffer `shown`.
    void draw(Time time, unsigned shown) {
        if (source_.motion) source_.motion->posesAt(time, {}, poses_);
        const double aspect = source_.pattern->aspect(), slice = 1.0 / static_cast<double>(poses_.size());
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            const glm::dmat3 turn = pattern::canvasFromShape({poses_[i].centre, 1, poses_[i].rotation});
            const glm::dvec3 scale(2 / aspect, -2, -slice);
            glm::mat4& matrix = instances_[i].clipFromShape;
            for (int axis = 0; axis < 3; ++axis) matrix[axis] = glm::vec4(scale * turn[axis] * poses_[i].size, 0);
            matrix[3] = glm::vec4(2 * poses_[i].centre.x / aspect - 1, 1 - 2 * poses_[i].centre.y,
                                  1 - (2 * static_cast<double>(i) + 1) * slice, 1);
            instances_[i].colour = source_.pattern->instances[i].colour;
        }
        glNamedBufferSubData(perInstance_, 0, static_cast<GLsizeiptr>(instances_.size() * sizeof(Instance)), instances_.data());

        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
        glViewport(0, 0, size_.x, size_.y);
        glEnable(GL_FRAMEBUFFER_SRGB);
        glEnable(GL_DEPTH_TEST);
        glDepthFunc(GL_LESS);
        glEnable(GL_CULL_FACE);
        glFrontFace(GL_CCW);
        glClearColor(0, 0, 0, 1);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        glUseProgram(program_.name());
        glBindVertexArray(array_);
        glDrawElementsInstanced(GL_TRIANGLES, indices_, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(instances_.size()));
        glDisable(GL_FRAMEBUFFER_SRGB);
        glBlitNamedFramebuffer(framebuffer_, shown, 0, 0, size_.x, size_.y, 0, 0, size_.x, size_.y, GL_COLOR_BUFFER_BIT,
                               GL_NEAREST);
    }

private:
    struct Instance {
        glm::mat4 clipFromShape{1};
        glm::vec3 colour{1};
    };
    PatternSource source_;
    glm::ivec2 size_;
    gpu::Program program_ = valueOf(gpu::loadProgram(kFolder / "floor.vert", kFolder / "floor.frag"));
    std::vector<pattern::InstancePose> poses_;
    std::vector<Instance> instances_;
    GLuint perInstance_ = 0, array_ = 0, framebuffer_ = 0;
    GLsizei indices_ = 0;
};

// The minimum of the frames' times is the cost of the work itself, the median its cost on this
// machine now.
struct Cost {
    std::vector<double> real, processor;  // ms per frame
    static double median(std::vector<double> of) {
        std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2), of.end());
        return of[of.size() / 2];
    }
};

void print(const Settings& settings, const std::vector<Variant>& all, const std::vector<Cost>& costs) {
    const auto per = static_cast<double>(settings.outputs);
    const Cost& floor = costs[0];
    fmt::print(
        "{} outputs of {} x {}, {} triangles each, {} samples per pixel, {}, {} frames of each kind; ms per output and frame, "
        "median\n",
        settings.outputs, settings.width, settings.height, settings.crystals * 60, settings.samples, settings.driver,
        settings.frames);
    fmt::print("{:<22}{:>10}{:>10}{:>10}{:>10}\n", "", "real", "CPU", "x floor", "x CPU");
    for (std::size_t way = 0; way < costs.size(); ++way)
        fmt::print("{:<22}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}\n", way == 0 ? "floor" : all[way - 1].name,
                   Cost::median(costs[way].real) / per, Cost::median(costs[way].processor) / per,
                   Cost::median(costs[way].real) / Cost::median(floor.real),
                   Cost::median(costs[way].processor) / Cost::median(floor.processor));
}

}  // namespace

void compareCost(const Settings& settings) {
    app::setThreadRank(app::Rank::Render);  // as the program does
    ManualClock clock;
    const SteadyClock watch;
    const std::vector<Variant> all = variants();
    const PatternSource source = swayingCrystals({settings.crystals});
    struct Output {
        std::unique_ptr<DisplaySink> sink;
        std::unique_ptr<Floor> floor;
        std::vector<std::unique_ptr<OutputRenderer>> ours;
    };
    std::vector<Output> outputs;
    for (int i = 0; i < settings.outputs; ++i) {
        Output& output = outputs.emplace_back();
        output.sink = opened(settings, i, clock);
        output.floor = std::make_unique<Floor>(source, output.sink->size(), settings.samples);
        for (const Variant& variant : all) output.ours.push_back(rendererOf(settings, source, variant));
    }
    const bool window = settings.driver != "headless";
    // Way 0 is the floor.
    const auto frame = [&](std::size_t way, Time time) {
        for (Output& output : outputs) {
            must(output.sink->makeCurrent());
            if (way == 0)
                output.floor->draw(time, window ? 0 : output.sink->framebuffer());
            else
                output.ours[way - 1]->draw(kLook, {}, time, output.sink->framebuffer());
        }
        for (Output& output : outputs) {
            must(output.sink->makeCurrent());
            // The floor draws into the window's back buffer, so it needs no copy from our
            // framebuffer.
            if (way == 0)
                glFinish();
            else
                must(output.sink->finish());
        }
        for (Output& output : outputs)
            FANTASCOPE_CHECK(output.sink->presentWith(clock.now()).has_value(), "the window stays open");
    };
    std::vector<Cost> costs(all.size() + 1);
    constexpr int kWarm = 5;
    for (int number = -kWarm; number < settings.frames; ++number) {
        const Time time = tickTime(number + kWarm, settings.rate);
        for (std::size_t way = 0; way < costs.size(); ++way) {
            const double processor = processorSeconds();
            const Time began = watch.now();
            frame(way, time);
            if (number < 0) continue;
            costs[way].real.push_back(1e3 * seconds(watch.now() - began));
            costs[way].processor.push_back(1e3 * (processorSeconds() - processor));
        }
    }
    print(settings, all, costs);
    for (Output& output : outputs) {
        must(output.sink->makeCurrent());
        output.ours.clear();
    }
}

}  // namespace fantascope::render
