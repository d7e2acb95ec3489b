#pragma once
// Pictures of the lens board as a camera with a known lens takes them, for tests of what is found
// in them.

#include "vision/camera_model.h"
#include "vision/lens_board.h"

#include "core/random.h"
#include "media/image.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::vision {

// Where the board is: its middle in camera axes (x right, y down, z forward), in squares, and its
// turns about its own x and y axes and the camera's z axis, degrees.
struct BoardPose {
    glm::dvec3 middle{0, 0, 20};
    glm::dvec3 turn{0};
};

// Draws the board as a camera sees it. Rays are traced once for all pictures.
class BoardCamera {
public:
    struct Conditions {
        double noise = 1.5;                               // standard deviation of stored values, of 255
        double blur = 0.6;                                // standard deviation, pixels
        double white = 0.7, black = 0.04, behind = 0.25;  // linear light
        // Light on the board by its place on it, 0..1 across and down.
        std::function<double(glm::dvec2)> light = [](glm::dvec2) { return 1.0; };
        // Whether something is before a place of the board, 0..1 across and down.
        std::function<bool(glm::dvec2)> covered = [](glm::dvec2) { return false; };
    };

    explicit BoardCamera(const CameraModel& camera) : camera_(camera), cells_(kCells.x * kCells.y, false) {
        for (const LensBoard::Box& box : LensBoard::boxes())
            for (int y = box.low.y; y < box.high.y; ++y)
                for (int x = box.low.x; x < box.high.x; ++x) cells_[std::size_t(y * kCells.x + x)] = box.dark;
        for (int y = 0; y < camera.size.y; ++y)
            for (int x = 0; x < camera.size.x; ++x)
                for (int i = 0; i < kSide * kSide; ++i)
                    rays_.push_back(camera.rayThrough({x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide}).direction);
    }

    RgbaImage picture(const BoardPose& pose, Rng& rng, const Conditions& conditions) const {
        const glm::dmat3 turn = turnOf(pose);
        const glm::dvec3 normal = turn[2];
        const double distance = glm::dot(normal, pose.middle);
        GreyImage light(camera_.size.x, camera_.size.y);
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const double along = distance / glm::dot(normal, rays_[i]);
            double value = conditions.behind;
            if (along > 0) {
                const glm::dvec3 local = glm::transpose(turn) * (along * rays_[i] - pose.middle);
                const glm::dvec2 place = glm::dvec2(local) + glm::dvec2(LensBoard::kSquares) / 2.0;
                if (const auto dark = isDark(place)) {
                    const glm::dvec2 share = place / glm::dvec2(LensBoard::kSquares);
                    value = (*dark ? conditions.black : conditions.white) * conditions.light(share);
                    if (conditions.covered(share)) value = 0.3;
                }
            }
            light.pixels()[i / (kSide * kSide)] += static_cast<float>(value / (kSide * kSide));
        }
        if (conditions.blur > 0) light = blurred(light, conditions.blur);
        RgbaImage stored(camera_.size.x, camera_.size.y);
        for (std::size_t i = 0; i < light.pixels().size(); ++i) {
            const double value = 255 * srgbFromLinear(std::min(1.0f, light.pixels()[i])) + conditions.noise * rng.normal();
            const auto byte = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
            stored.pixels()[i] = {byte, byte, byte, 255};
        }
        return stored;
    }
    RgbaImage picture(const BoardPose& pose, Rng& rng) const { return picture(pose, rng, Conditions()); }

    // Where the camera sees a corner of the board.
    std::optional<glm::dvec2> pixelOf(int corner, const BoardPose& pose) const {
        const glm::dvec2 local = LensBoard::placeOf(corner) - glm::dvec2(LensBoard::kSquares) / 2.0;
        return camera_.pixelFromWorld(pose.middle + turnOf(pose) * glm::dvec3(local, 0));
    }

    // Poses that a person would take who follows the advice: all over the picture, near and far,
    // tilted to all sides.
    std::vector<BoardPose> poses(int count, Rng& rng) const {
        std::vector<BoardPose> poses;
        for (int i = 0; i < count; ++i) {
            // The board fills 45 to 80 % of the picture's width.
            const double squares = LensBoard::kSquares.x / rng.uniform(0.45, 0.8);
            BoardPose pose;
            pose.middle.z = squares * camera_.focal / camera_.size.x;
            const glm::dvec2 at = glm::dvec2(i % 3, i / 3 % 3) / 2.0 - 0.5;  // of the picture
            pose.middle.x = at.x * 0.75 * squares;
            pose.middle.y = at.y * 0.75 * squares * camera_.size.y / camera_.size.x;
            const double angle = glm::radians(360.0) * i * 0.381966, tilt = rng.uniform(15, 38);
            pose.turn = {tilt * std::sin(angle), tilt * std::cos(angle), rng.uniform(-25, 25)};
            poses.push_back(pose);
        }
        return poses;
    }

private:
    static constexpr int kSide = 3;         // samples across and down a pixel
    static constexpr double kMargin = 0.8;  // of white paper around the board, squares
    static constexpr glm::ivec2 kCells = LensBoard::kSquares * LensBoard::kCells;

    static glm::dmat3 turnOf(const BoardPose& pose) {
        return rotationXyz({0, 0, glm::radians(pose.turn.z)}) * rotationXyz({glm::radians(pose.turn.x), 0, 0}) *
               rotationXyz({0, glm::radians(pose.turn.y), 0});
    }
    // Nothing beside the paper.
    std::optional<bool> isDark(glm::dvec2 place) const {
        const glm::dvec2 size = LensBoard::kSquares;
        if (place.x < -kMargin || place.y < -kMargin || place.x > size.x + kMargin || place.y > size.y + kMargin)
            return std::nullopt;
        if (place.x < 0 || place.y < 0 || place.x >= size.x || place.y >= size.y) return false;
        const glm::ivec2 cell(place * double(LensBoard::kCells));
        return cells_[std::size_t(cell.y * kCells.x + cell.x)];
    }

    const CameraModel camera_;
    std::vector<bool> cells_;
    std::vector<glm::dvec3> rays_;
};

}  // namespace fantascope::vision
