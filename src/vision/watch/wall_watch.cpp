#include "vision/watch/wall_watch.h"

#include "vision/watch/surface_texture.h"

#include "core/check.h"
#include "core/median.h"

#include <glm/common.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fantascope::vision {
namespace {

constexpr int kWidth = 640;             // camera pixels across that are enough
constexpr float kSaturated = 1;         // linear light that says nothing
constexpr double kGood = 0.5;           // agreement x share of the content: a picture that is found
constexpr double kLost = 0.7;           // of the usual agreement: the picture may have moved far
constexpr double kSettled = 0.3;        // cells: a picture that has moved by less has not moved
constexpr double kErrorOfModel = 0.09;  // cells: what is wrong in the prediction may pretend so much
constexpr double kForgets = 0.1;        // weight of a new picture in what is usual

// Bilinear between the middles of pixels; at the edge as the edge.
float valueAt(const GreyImage& image, glm::vec2 at) {
    const glm::vec2 corner = glm::floor(at - 0.5f), share = at - 0.5f - corner;
    const int x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
    const int x0 = std::clamp(x, 0, image.width() - 1), x1 = std::clamp(x + 1, 0, image.width() - 1),
              y0 = std::clamp(y, 0, image.height() - 1), y1 = std::clamp(y + 1, 0, image.height() - 1);
    return glm::mix(glm::mix(image.at(x0, y0), image.at(x1, y0), share.x), glm::mix(image.at(x0, y1), image.at(x1, y1), share.x),
                    share.y);
}

Homography inPixels(const Homography& inCells, double cellSize) {
    const glm::dmat3 scale(cellSize, 0, 0, 0, cellSize, 0, 0, 0, 1);
    return Homography(scale * inCells.matrix() * glm::inverse(scale));
}

double scoreOf(const std::optional<Registration>& found) {
    return found && found->gain > 0 ? found->agreement * found->used : -1;
}

}  // namespace

// An output's part of a camera picture, by cells.
struct WallWatch::Seen {
    GreyImage light;  // that the camera gets, without all other light that is known
    GreyImage mask;   // 1 where it is valid
};

struct WallWatch::Output {
    OutputView view;
    bool isSurveyed;
    Image<glm::vec2> cell;  // by coarse camera pixel: the place in cells that lights it; NaN: none
    GreyImage full;         // by coarse camera pixel: its full light
    double dark = 0;        // light that is known of the dark, as a share of full light; the median
    Homography now;         // in cells
    SurfaceTexture surface;
    Homography learnedAt{};  // in cells: `now` when the surface was learned
    int unfound = 0;         // pictures before the first one that was found
    double gain = 0;         // as usual; 0: unknown
    double score = 0;        // as usual
    int sinceWide = 99;      // pictures since the last wide search
    LightMeter meter{};
    WallReflectance reflectance{};
    GreyImage alone{};             // by cell: 1 where no other output gives light
    Image<std::uint8_t> shared{};  // by coarse camera pixel: 1 where cells of another output lie
    int looks = 0;                 // pictures in which it was found
    // The picture that was looked at last; empty: it says nothing of this output.
    Seen seen{};
    GreyImage light{};
    bool isFound = false;

    // What the camera gets of this output where cells of another lie, by coarse camera pixels.
    void addTo(GreyImage& seen, const GreyImage& light) const {
        for (int y = 0; y < seen.height(); ++y)
            for (int x = 0; x < seen.width(); ++x) {
                if (full.at(x, y) <= 0 || shared.at(x, y) == 0) continue;
                const glm::dvec2 at = now(glm::dvec2(cell.at(x, y)));
                if (at.x < 0 || at.y < 0 || at.x > light.width() || at.y > light.height()) continue;
                seen.at(x, y) += static_cast<float>(gain * surface.level()) * full.at(x, y) * valueAt(light, glm::vec2(at));
            }
    }
    std::optional<Registration> find(const GreyImage& seen, const GreyImage& light, const GreyImage& mask);
    std::optional<OutputSight> look(const GreyImage& seen, const GreyImage& light, const GreyImage& mask);
    std::optional<OutputLight> measure();
    // Its full light where no other output gives any.
    GreyImage fullAlone() const {
        GreyImage lit = surface.full();
        for (std::size_t p = 0; p < lit.pixels().size(); ++p) lit.pixels()[p] *= alone.pixels()[p];
        return lit;
    }
    void findDark(const GreyImage& seen);
};

// Follows the picture. A picture that is not found near its last place is searched for more widely,
// but not with every camera picture, since that takes longer.
std::optional<Registration> WallWatch::Output::find(const GreyImage& seen, const GreyImage& light, const GreyImage& mask) {
    constexpr int kWideEvery = 3;
    std::optional<Registration> found = registerPictures(seen, light, mask, now, SearchRange::Near);
    if (++sinceWide >= kWideEvery && scoreOf(found) < std::max(kGood, kLost * score)) {
        sinceWide = 0;
        for (const Homography& start : {now, Homography()}) {
            const auto wide = registerPictures(seen, light, mask, start, SearchRange::Wide);
            if (scoreOf(wide) > scoreOf(found)) found = wide;
        }
    }
    return found;
}

// The surface is learned where the plan says the picture is, until the picture itself is found.
std::optional<OutputSight> WallWatch::Output::look(const GreyImage& seen, const GreyImage& light, const GreyImage& mask) {
    constexpr int kLearnsUnfound = 30;  // pictures
    isFound = false;
    const auto found = find(surface.shareOf(seen), light, mask);
    if (!found || scoreOf(found) < kGood) {
        if (score == 0 && ++unfound <= kLearnsUnfound) surface.learn(seen, light, mask, now);
        if (!found || scoreOf(found) <= 0) return std::nullopt;
    }
    const double size = view.cellSize();
    OutputSight sight{inPixels(found->expectedFromSeen, size), std::hypot(found->sigma, kErrorOfModel) * size, found->gain,
                      found->agreement, found->used};
    if (scoreOf(found) < kGood) return sight;
    now = found->expectedFromSeen;
    isFound = true;
    ++looks;
    if (score == 0 && !isSurveyed) {
        learnedAt = now;
        surface.forget();
    }
    const Homography moved = learnedAt.inverse() * now;
    if (rmsMovement(moved, {0, 0}, {seen.width(), seen.height()}) > kSettled)
        sight.surfaceStayed = surface.stayed(seen, light, mask, now, moved, found->gain);
    surface.learn(seen, light, mask, now);
    const auto usual = [](double& value, double newest) { value = value == 0 ? newest : value + kForgets * (newest - value); };
    usual(gain, found->gain);
    usual(score, scoreOf(found));
    return sight;
}

WallWatch::WallWatch(const std::vector<std::optional<WatchedOutput>>& outputs, glm::ivec2 camera, const CameraLight& light)
    : camera_(camera), step_(std::max(1, static_cast<int>(std::lround(camera.x / static_cast<double>(kWidth))))), light_(light) {
    const glm::ivec2 coarse = camera / step_;
    dark_ = GreyImage(coarse.x, coarse.y);
    for (const std::optional<WatchedOutput>& watched : outputs)
        if (watched && !watched->dark.empty()) dark_ = resized(watched->dark, coarse.x, coarse.y);
    for (const std::optional<WatchedOutput>& watched : outputs) {
        outputs_.push_back(nullptr);
        if (!watched) continue;
        const auto view = OutputView::of(watched->map, watched->projector, watched->gamma, step_);
        if (!view) continue;
        outputs_.back() = std::make_unique<Output>(Output{.view = *view,
                                                          .isSurveyed = watched->isSurveyed,
                                                          .cell = Image<glm::vec2>(coarse.x, coarse.y),
                                                          .full = GreyImage(coarse.x, coarse.y),
                                                          .now = {},
                                                          .surface = SurfaceTexture(view->full(), watched->isSurveyed)});
        Output& output = *outputs_.back();
        const auto size = static_cast<float>(view->cellSize());
        for (int y = 0; y < coarse.y; ++y)
            for (int x = 0; x < coarse.x; ++x) {
                const int middle = step_ / 2;
                const glm::vec2 at = watched->map.at.at(x * step_ + middle, y * step_ + middle);
                if (at.x != at.x) continue;
                output.cell.at(x, y) = at / size;
                output.full.at(x, y) = watched->map.light.at(x * step_ + middle, y * step_ + middle);
            }
        output.findDark(dark_);
    }
    findShared();
    findAlone();
    findSurroundings();
}

WallWatch::~WallWatch() = default;

bool WallWatch::watches(std::size_t output) const { return outputs_[output] != nullptr; }

GreyImage WallWatch::lightOf(std::size_t output, const RgbaImage& frame) const { return outputs_[output]->view.lightOf(frame); }

// By coarse camera pixels; negative where a pixel is saturated.
GreyImage WallWatch::lightSeen(const RgbaImage& picture) const {
    GreyImage fine(camera_.x, camera_.y);
    light_.addTo(fine, picture);
    GreyImage light(camera_.x / step_, camera_.y / step_);
    for (int y = 0; y < light.height(); ++y)
        for (int x = 0; x < light.width(); ++x) {
            float sum = 0, most = 0;
            for (int row = y * step_; row < (y + 1) * step_; ++row)
                for (int column = x * step_; column < (x + 1) * step_; ++column) {
                    sum += fine.at(column, row);
                    most = std::max(most, fine.at(column, row));
                }
            light.at(x, y) = most >= kSaturated ? -1 : sum / static_cast<float>(step_ * step_);
        }
    return light;
}

WallWatch::Seen WallWatch::seenOf(std::size_t output, const GreyImage& light, const std::vector<GreyImage>& predicted) const {
    GreyImage rest = light;  // without all other light that is known
    for (std::size_t p = 0; p < rest.pixels().size(); ++p) {
        if (light.pixels()[p] < 0) continue;
        float& left = rest.pixels()[p];
        left -= dark_.pixels()[p];
        for (std::size_t other = 0; other < outputs_.size(); ++other)
            if (other != output && !predicted[other].empty()) left -= predicted[other].pixels()[p];
    }
    const OutputView& view = outputs_[output]->view;
    const GreyImage& full = view.full();
    Seen seen{GreyImage(full.width(), full.height()), GreyImage(full.width(), full.height())};
    for (int y = 0; y < full.height(); ++y)
        for (int x = 0; x < full.width(); ++x) {
            if (full.at(x, y) <= 0) continue;
            const glm::vec2 at = view.camera().at(x, y) / static_cast<float>(step_);
            const int column = std::clamp(static_cast<int>(at.x), 0, light.width() - 1),
                      row = std::clamp(static_cast<int>(at.y), 0, light.height() - 1);
            if (light.at(column, row) < 0) continue;
            seen.light.at(x, y) = valueAt(rest, at);
            seen.mask.at(x, y) = 1;
        }
    return seen;
}

std::vector<std::optional<OutputSight>> WallWatch::look(const RgbaImage& picture, const std::vector<const GreyImage*>& shown) {
    FANTASCOPE_CHECK(picture.width() == camera_.x && picture.height() == camera_.y, "the camera's pictures have one size");
    seen_ = lightSeen(picture);
    const GreyImage& light = seen_;
    std::vector<GreyImage> predicted(outputs_.size());
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i] || shown[i] == nullptr) continue;
        predicted[i] = GreyImage(light.width(), light.height());
        outputs_[i]->addTo(predicted[i], *shown[i]);
    }
    std::vector<std::optional<OutputSight>> sights(outputs_.size());
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i]) continue;
        Output& output = *outputs_[i];
        output.light = shown[i] != nullptr ? *shown[i] : GreyImage();
        if (shown[i] == nullptr) continue;
        output.seen = seenOf(i, light, predicted);
        sights[i] = output.look(output.seen.light, output.light, output.seen.mask);
    }
    return sights;
}

// For each output, the pixels from which the light of other outputs' cells is interpolated.
void WallWatch::findShared() {
    const glm::ivec2 last(dark_.width() - 1, dark_.height() - 1);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i]) continue;
        Image<std::uint8_t>& shared = outputs_[i]->shared;
        shared = Image<std::uint8_t>(dark_.width(), dark_.height());
        for (std::size_t other = 0; other < outputs_.size(); ++other) {
            if (other == i || !outputs_[other]) continue;
            const OutputView& view = outputs_[other]->view;
            for (std::size_t cell = 0; cell < view.full().pixels().size(); ++cell) {
                if (view.full().pixels()[cell] <= 0) continue;
                const glm::ivec2 corner(glm::floor(view.camera().pixels()[cell] / static_cast<float>(step_) - 0.5f));
                for (const glm::ivec2 by : {glm::ivec2(0, 0), {1, 0}, {0, 1}, {1, 1}}) {
                    const glm::ivec2 at = glm::clamp(corner + by, glm::ivec2(0), last);
                    shared.at(at.x, at.y) = 1;
                }
            }
        }
    }
}

// The full light of all outputs but one, by coarse camera pixels; each pixel as the brightest about
// it, since the camera blurs.
GreyImage WallWatch::lightBeside(std::size_t output) const {
    constexpr int kBlurs = 2;  // coarse camera pixels
    GreyImage sum(dark_.width(), dark_.height());
    for (std::size_t other = 0; other < outputs_.size(); ++other)
        for (std::size_t p = 0; other != output && outputs_[other] && p < sum.pixels().size(); ++p)
            sum.pixels()[p] += outputs_[other]->full.pixels()[p];
    GreyImage light(sum.width(), sum.height());
    cv::Mat out(light.height(), light.width(), CV_32F, light.pixels().data());
    cv::dilate(cv::Mat(sum.height(), sum.width(), CV_32F, sum.pixels().data()), out,
               cv::getStructuringElement(cv::MORPH_RECT, {2 * kBlurs + 1, 2 * kBlurs + 1}));
    return light;
}

// The cells of each output that no other output lights. An output that has few of them is measured
// everywhere.
void WallWatch::findAlone() {
    constexpr float kHardly = 0.1f;
    constexpr double kFew = 0.3;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i]) continue;
        const OutputView& view = outputs_[i]->view;
        const GreyImage& full = view.full();
        GreyImage& alone = outputs_[i]->alone;
        alone = GreyImage(full.width(), full.height());
        const GreyImage others = lightBeside(i);
        const glm::ivec2 last(others.width() - 1, others.height() - 1);
        std::size_t lit = 0, count = 0;
        for (int y = 0; y < full.height(); ++y)
            for (int x = 0; x < full.width(); ++x) {
                if (full.at(x, y) <= 0) continue;
                ++lit;
                const glm::ivec2 at = glm::min(glm::ivec2(view.camera().at(x, y) / static_cast<float>(step_)), last);
                if (others.at(at.x, at.y) > kHardly * full.at(x, y)) continue;
                alone.at(x, y) = 1;
                ++count;
            }
        if (static_cast<double>(count) < kFew * static_cast<double>(lit)) std::ranges::fill(alone.pixels(), 1.0f);
    }
}

// Where no output gives light.
void WallWatch::findSurroundings() {
    GreyImage mask(dark_.width(), dark_.height(), 1);
    for (const auto& output : outputs_)
        for (std::size_t p = 0; output && p < mask.pixels().size(); ++p)
            if (output->full.pixels()[p] > 0) mask.pixels()[p] = 0;
    surroundings_.emplace(mask);
}

std::optional<OutputLight> WallWatch::Output::measure() {
    constexpr int kLearnsSurface = 50;  // pictures
    if (light.empty() || score == 0 || (!isSurveyed && looks < kLearnsSurface)) return std::nullopt;
    auto measured = meter.measure({seen.light, fullAlone(), light, seen.mask, now}, isFound);
    if (measured) measured->allOtherLight += dark;
    return measured;
}

bool WallWatch::measureSurface(std::size_t output) {
    Output* const watched = outputs_[output].get();
    if (watched == nullptr || !watched->isSurveyed || !watched->isFound || watched->light.empty()) return false;
    return watched->reflectance.add(
        {watched->seen.light, watched->fullAlone(), watched->light, watched->seen.mask, watched->now});
}

WallChange WallWatch::surfaceChange(std::size_t output) const {
    const Output& watched = *outputs_[output];
    return watched.reflectance.change(watched.view.cellSize());
}

void WallWatch::Output::findDark(const GreyImage& seen) {
    std::vector<double> shares;
    for (std::size_t p = 0; p < full.pixels().size(); ++p)
        if (full.pixels()[p] > 0) shares.push_back(seen.pixels()[p] / full.pixels()[p]);
    if (!shares.empty()) dark = medianOf(std::move(shares));
}

WallLight WallWatch::measureLight() {
    WallLight light;
    for (const auto& output : outputs_) light.outputs.push_back(output ? output->measure() : std::nullopt);
    light.isSettling = surroundings_->isLearning();
    light.surroundings = surroundings_->measure(seen_);
    return light;
}

bool WallWatch::isUpsideDown() const {
    GreyImage turned = seen_;
    std::ranges::reverse(turned.pixels());
    const std::vector<GreyImage> nothing(outputs_.size());
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i] || outputs_[i]->light.empty() || outputs_[i]->isFound) continue;
        const Output& output = *outputs_[i];
        const Seen seen = seenOf(i, turned, nothing);
        const auto found =
            registerPictures(output.surface.shareOf(seen.light), output.light, seen.mask, output.now, SearchRange::Near);
        if (scoreOf(found) > kGood) return true;
    }
    return false;
}

void WallWatch::lampsChange(const std::optional<LampState>& state) {
    surroundings_->lampsChange(state);
    for (const auto& output : outputs_)
        if (output) output->meter.lampsChange(state);
}

std::optional<CameraMovement> WallWatch::cameraMovement(const std::vector<const Homography*>& shownFromPlace) const {
    constexpr int kEvery = 4;  // cells
    std::vector<cv::Point2d> now, before;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (!outputs_[i] || shownFromPlace[i] == nullptr) continue;
        const OutputView& view = outputs_[i]->view;
        const Image<glm::vec2>& camera = view.camera();
        const double size = view.cellSize();
        for (int y = 0; y < camera.height(); y += kEvery)
            for (int x = 0; x < camera.width(); x += kEvery) {
                if (view.full().at(x, y) <= 0) continue;
                const glm::dvec2 from = (*shownFromPlace[i])((glm::dvec2(x, y) + 0.5) * size) / size - 0.5;
                const glm::ivec2 corner(glm::floor(from));
                if (corner.x < 0 || corner.y < 0 || corner.x + 1 >= camera.width() || corner.y + 1 >= camera.height()) continue;
                const glm::vec2 share = glm::vec2(from - glm::dvec2(corner));
                const glm::vec2 place = glm::mix(
                    glm::mix(camera.at(corner.x, corner.y), camera.at(corner.x + 1, corner.y), share.x),
                    glm::mix(camera.at(corner.x, corner.y + 1), camera.at(corner.x + 1, corner.y + 1), share.x), share.y);
                if (place.x != place.x) continue;
                now.emplace_back(camera.at(x, y).x, camera.at(x, y).y);
                before.emplace_back(place.x, place.y);
            }
    }
    constexpr std::size_t kLeastPlaces = 30;
    if (now.size() < kLeastPlaces) return std::nullopt;
    const cv::Mat found = cv::findHomography(now, before);
    if (found.empty()) return std::nullopt;
    std::vector<cv::Point2d> explained;
    cv::perspectiveTransform(now, explained, found);
    CameraMovement movement;
    for (std::size_t i = 0; i < now.size(); ++i) {
        const cv::Point2d by = now[i] - before[i], off = explained[i] - before[i];
        movement.px += by.dot(by);
        movement.missed += off.dot(off);
    }
    const auto count = static_cast<double>(now.size());
    return CameraMovement{std::sqrt(movement.px / count), std::sqrt(movement.missed / count)};
}

}  // namespace fantascope::vision
