#include "show/course/picture_shift.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>

namespace fantascope::show {

std::optional<Homography> mapOf(const PictureShift& shift, glm::ivec2 size) {
    const auto corners = rectangleCorners(size.x, size.y);
    auto moved = corners;
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += glm::dvec2(shift[i]);
    const auto map = Homography::fromCorners(corners, moved);
    return map ? std::optional(*map) : std::nullopt;
}

PictureShift shiftOf(const Homography& map, glm::ivec2 size) {
    const auto corners = rectangleCorners(size.x, size.y);
    PictureShift shift;
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = glm::vec2(map(corners[i]) - corners[i]);
    return shift;
}

float farthestOf(const PictureShift& shift) {
    float farthest = 0;
    for (const glm::vec2 corner : shift) farthest = std::max(farthest, glm::length(corner));
    return farthest;
}

void ShiftCourses::want(std::size_t output, const PictureShift& shift, Time at, double speed) {
    if (moves_.size() <= output) moves_.resize(output + 1);
    const PictureShift from = this->at(output, at);
    PictureShift way;
    for (std::size_t i = 0; i < way.size(); ++i) way[i] = shift[i] - from[i];
    moves_[output].set(at, {at, fromSeconds(farthestOf(way) / speed), from, shift});
}

void ShiftCourses::takeBack(Time at, double speed) {
    for (std::size_t output = 0; output < moves_.size(); ++output) want(output, {}, at, speed);
}

PictureShift ShiftCourses::at(std::size_t output, Time time) const {
    if (output >= moves_.size()) return {};
    const Move& move = moves_[output].at(time);
    if (move.length == Time{} || time - move.at >= move.length) return move.to;
    const auto share = static_cast<float>(seconds(time - move.at) / seconds(move.length));
    PictureShift shift;
    for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = glm::mix(move.from[i], move.to[i], share);
    return shift;
}

void ShiftCourses::forget(Time time) {
    for (Steps<Move>& moves : moves_) moves.forget(time);
}

}  // namespace fantascope::show
