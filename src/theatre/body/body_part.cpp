#include "theatre/body/body_part.h"

#include <algorithm>
#include <array>

namespace fantascope::theatre {
namespace {

constexpr std::array<std::string_view, kBodyParts> kNames = {
    "head",      "neck",       "chest",    "pelvis",    "left shoulder", "right shoulder", "left elbow", "right elbow",
    "left hand", "right hand", "left hip", "right hip", "left knee",     "right knee",     "left foot",  "right foot"};
// The plurals of the pairs, in their order.
constexpr std::size_t kFirstPair = static_cast<std::size_t>(BodyPart::LeftShoulder);
constexpr std::array<std::string_view, (kBodyParts - kFirstPair) / 2> kPlurals = {"shoulders", "elbows", "hands",
                                                                                  "hips",      "knees",  "feet"};

}  // namespace

std::string_view name(BodyPart part) { return kNames[static_cast<std::size_t>(part)]; }

const std::vector<std::string>& partNames() {
    static const std::vector<std::string> names(kNames.begin(), kNames.end());
    return names;
}

const std::vector<std::string>& partWords() {
    static const std::vector<std::string> words = [] {
        std::vector<std::string> words = partNames();
        words.insert(words.end(), kPlurals.begin(), kPlurals.end());
        return words;
    }();
    return words;
}

std::vector<BodyPart> partsOf(std::string_view word) {
    const auto index = [&](const auto& words) {
        return static_cast<std::size_t>(std::find(words.begin(), words.end(), word) - words.begin());
    };
    if (const std::size_t one = index(kNames); one < kNames.size()) return {static_cast<BodyPart>(one)};
    if (const std::size_t pair = index(kPlurals); pair < kPlurals.size())
        return {static_cast<BodyPart>(kFirstPair + 2 * pair), static_cast<BodyPart>(kFirstPair + 2 * pair + 1)};
    return {};
}

}  // namespace fantascope::theatre
