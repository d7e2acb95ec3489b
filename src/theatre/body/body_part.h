#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::theatre {

// Parts of a body by the names that artists use. A part may match a hint (Won & Lee 2016, Table 1)
// or hold a prop. Left and right are the body's own.
enum class BodyPart : std::uint8_t {
    Head,
    Neck,
    Chest,
    Pelvis,
    LeftShoulder,
    RightShoulder,
    LeftElbow,
    RightElbow,
    LeftHand,
    RightHand,
    LeftHip,
    RightHip,
    LeftKnee,
    RightKnee,
    LeftFoot,
    RightFoot,
};
constexpr std::size_t kBodyParts = 16;

std::string_view name(BodyPart part);  // "left hand"
// The names of all parts, in their order. Each stands for one part.
const std::vector<std::string>& partNames();
// The same, and the plurals ("hands", "feet"), each of which stands for the left part and the right
// part.
const std::vector<std::string>& partWords();
// The parts that a word of partWords() stands for. Empty for any other word.
std::vector<BodyPart> partsOf(std::string_view word);

}  // namespace fantascope::theatre
