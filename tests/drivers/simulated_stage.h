#pragma once
// A small simulated site that tests play on: a wall with two pictures, three lamps and a camera.

#include "drivers/site/simulated_site.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::site {

using namespace std::chrono_literals;

// A wall with two pictures side by side, a lamp of three colours and a street lamp, seen by a small
// camera.
inline NominalSite nominalSite() {
    const auto facing = [](glm::dvec3 position, glm::dvec3 target) { return Pose::lookingAt(position, target).value(); };
    const auto projectorAt = [&](double x) {
        return vision::CameraModel::fromThrowRatio(facing({x, 0, 3}, {x, 0, 0}), {64, 64}, 2, {0, 0});
    };
    NominalSite site;
    site.outputs = {{"left", projectorAt(-1)}, {"right", projectorAt(1)}};
    site.fixtures = {{"spot", 3, 10, {"intensity", "pan"}}, {"wash", 3, 12, {"red", "green", "blue"}}};
    site.relays = {{"road", "road", 1}};
    site.contacts = {{"gate", "doors", 3}, {"emergency", "desk", 3}};
    site.camera = vision::CameraModel::fromFieldOfView(facing({0, 0, 4}, {0, 0, 0}), {48, 24}, 1.0).value();
    site.devices = {"left", "right", "universe 3", "road", "camera"};
    return site;
}

// The simulation's keys; `more` is appended, so that a test may add faults or errors.
inline std::string simulationText(const std::string& more = "", const std::string& camera = "white: 40") {
    return fmt::format(R"(ambient: [1, 1, 1]
objects:
  - {{name: wall, rectangle: {{corner: [-5, -5, 0], right: [10, 0, 0], up: [0, 10, 0]}}, reflectance: [0.5, 0.5, 0.5]}}
projectors:
  left: {{lumens: 300, black_level: 0.01}}
  right: {{lumens: 300, black_level: 0.01}}
lamps:
  spot: {{position: [0, 0, 5], look_at: [0, 0, 0], beam_angle: 60, field_angle: 80, candela: 500}}
  wash: {{position: [0, 0, 5], look_at: [0, 0, 0], beam_angle: 60, field_angle: 80, candela: 500}}
street_lamps:
  road: {{position: [0, 0, 5], look_at: [0, 0, 0], beam_angle: 60, field_angle: 80, candela: 500, colour: [1, 0.5, 0]}}
camera: {{{}, latency: 0.05, frame_rate: 10}}
{})",
                       camera, more);
}

inline const std::string kNoiseless = "white: 40, read_noise: 0, shot_noise: 0";

class Stage {
public:
    explicit Stage(const std::string& more = "", const std::string& camera = kNoiseless, std::uint64_t seed = 1,
                   const std::filesystem::path& file = "site.yaml") {
        const ConfigNode node = ConfigNode::parse(simulationText(more, camera), file).value();
        site_ = SimulatedSite::open(node, nominalSite(), seed, world_).value();
        world_.installRelays("road", {true, false});
        site_->begin(Time{});
    }

    void show(const std::string& output, std::uint8_t value) {
        world_.setFrame(output, std::make_shared<const RgbaImage>(64, 64, Rgba8{value, value, value, 255}));
    }
    void setSlot(int address, std::uint8_t value) {
        slots_[static_cast<std::size_t>(address - 1)] = value;
        world_.setSlots(3, slots_);
    }
    void advanceTo(Time time) {
        clock_.advanceTo(time);
        site_->advanceTo(clock_.now());
    }
    // The camera's next frame from now on.
    std::shared_ptr<const CameraFrame> look() {
        (void)world_.takeFromCamera();
        advanceTo(clock_.now() + 100ms);
        clock_.advance(60ms);
        return world_.takeFromCamera();
    }
    // The picture that the camera exposes at a time: a multiple of 100 ms, later than now.
    RgbaImage pictureAt(Time time) {
        advanceTo(time - 100ms);
        return look()->image;
    }
    // Stored values in the middle of the left and of the right picture, and between them.
    std::vector<Rgba8> lookAtPictures() {
        const auto frame = look();
        return {frame->image.at(13, 12), frame->image.at(34, 12), frame->image.at(24, 12)};
    }

    ManualClock clock_;
    World world_{clock_};
    std::unique_ptr<SimulatedSite> site_;
    std::array<std::uint8_t, kDmxSlots> slots_{};
};

inline double linear(std::uint8_t stored) { return linearFromSrgb(static_cast<float>(stored) / 255); }

inline std::vector<std::string> told(const SimulatedSite& site) {
    std::vector<std::string> texts;
    for (const Happening& happening : site.happenings())
        texts.push_back(fmt::format("{:.1f} {}", seconds(happening.at), happening.text));
    return texts;
}

// What is wrong with a simulation of this text; "accepted" if nothing is.
inline std::string refusal(const std::string& text) {
    ManualClock clock;
    World world(clock);
    const auto site = SimulatedSite::open(ConfigNode::parse(text, "config/site.yaml").value(), nominalSite(), 1, world);
    return site ? "accepted" : site.error().message();
}

}  // namespace fantascope::site
