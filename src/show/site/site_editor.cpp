#include "show/site/site_editor.h"

#include "show/site/light_values.h"
#include "show/site/mask_handles.h"
#include "show/site/projection_changes.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace fantascope::show {
namespace {

using edit::Tool;

// This is more than an evening's work. Each step keeps one projection: a mesh and masks at most.
constexpr std::size_t kMostUndone = 1000;

// Coarse, usual and fine steps. A tenth of a pixel moves an antialiased edge just visibly.
constexpr std::array<double, 3> kPixels = {10, 1, 0.1}, kShares = {0.01, 0.001, 0.0001};
constexpr double kPixelGrain = 100, kShareGrain = 100000;  // values are rounded to 1 / grain, so that files stay readable

double rounded(double value, double grain) { return std::round(value * grain) / grain; }
glm::dvec2 rounded(glm::dvec2 value, double grain) { return {rounded(value.x, grain), rounded(value.y, grain)}; }

constexpr std::string_view kCornerNames[] = {"top left", "top right", "bottom right", "bottom left", "whole picture"};
constexpr std::string_view kEdgeNames[] = {"left edge", "top edge", "right edge", "bottom edge"};
constexpr std::string_view kToolNames[] = {"corners", "mesh", "part of the canvas", "masks", "light"};
constexpr std::size_t kWhole = 4;  // the index of "whole picture"
constexpr const char* kNoMaskChosen = "choose a mask first";

// (`index` + `step`) modulo `count`, never negative.
std::size_t stepped(std::size_t index, int step, std::size_t count) {
    const auto size = static_cast<std::ptrdiff_t>(count);
    return static_cast<std::size_t>(((static_cast<std::ptrdiff_t>(index) + step) % size + size) % size);
}

glm::dvec2 edgeMiddle(const CanvasPart& part, std::size_t edge) {
    const glm::dvec2 middle = (part.low + part.high) / 2.0;
    const glm::dvec2 middles[] = {
        {part.low.x, middle.y}, {middle.x, part.low.y}, {part.high.x, middle.y}, {middle.x, part.high.y}};
    return middles[edge];
}

double& edgeOf(CanvasPart& part, std::size_t edge) {
    double* const edges[] = {&part.low.x, &part.low.y, &part.high.x, &part.high.y};
    return *edges[edge];
}

}  // namespace

SiteEditor::SiteEditor(Site site) : site_(std::move(site)) { saved(); }

Result<void> SiteEditor::apply(const EditCommand& command) {
    return std::visit([this](const auto& kind) { return run(kind); }, command);
}

std::size_t SiteEditor::handleCount() const {
    switch (tool_) {
        case Tool::Corners:
            return std::size(kCornerNames);
        case Tool::Mesh:
            return std::max<std::size_t>(1, projection().warp.shape().mesh.offsets.size());
        case Tool::Part:
            return std::size(kEdgeNames);
        case Tool::Masks:
            return std::max<std::size_t>(1, maskHandles(projection().masks).size());
        case Tool::Light:
            break;
    }
    return std::size(kLightValues);
}

std::vector<EditHandle> SiteEditor::handles() const {
    const Warp& warp = projection().warp;
    const WarpShape& shape = warp.shape();
    std::vector<EditHandle> handles;
    switch (tool_) {
        case Tool::Corners: {
            // The corners as they are seen: with the mesh, if there is one.
            const auto square = rectangleCorners(1, 1);
            for (std::size_t i = 0; i < 4; ++i)
                handles.push_back({shape.corners[i] + warp.offsetAt(square[i]), std::string(kCornerNames[i])});
            handles.push_back(
                {warp.keystoneFromPicture()({0.5, 0.5}) + warp.offsetAt({0.5, 0.5}), std::string(kCornerNames[kWhole])});
            break;
        }
        case Tool::Mesh:
            for (std::size_t i = 0; i < shape.mesh.offsets.size(); ++i) {
                const int x = static_cast<int>(i) % shape.mesh.points.x, y = static_cast<int>(i) / shape.mesh.points.x;
                const glm::dvec2 onPicture = glm::dvec2(x, y) / glm::dvec2(shape.mesh.points - 1);
                handles.push_back(
                    {warp.keystoneFromPicture()(onPicture) + shape.mesh.offsets[i], fmt::format("{} | {}", x + 1, y + 1)});
            }
            if (handles.empty()) handles.push_back({std::nullopt, "no mesh"});
            break;
        case Tool::Part:
            for (std::size_t edge = 0; edge < std::size(kEdgeNames); ++edge)
                handles.push_back({warp.projectorFromCanvas(edgeMiddle(shape.part, edge)), std::string(kEdgeNames[edge])});
            break;
        case Tool::Masks:
            for (const MaskHandle& handle : maskHandles(projection().masks))
                handles.push_back(editHandle(projection().masks, handle));
            if (handles.empty()) handles.push_back({std::nullopt, "no mask"});
            break;
        case Tool::Light:
            for (const LightValue& value : kLightValues) handles.push_back({std::nullopt, std::string(value.name)});
            break;
    }
    return handles;
}

std::vector<std::string> SiteEditor::lines() const {
    const WarpShape& shape = projection().warp.shape();
    std::string value, step;
    switch (tool_) {
        case Tool::Corners:
            value = handle_ == kWhole ? "" : pointOf(shape.corners[handle_]);
            step = fmt::format("{:g} px", kPixels[static_cast<std::size_t>(step_)]);
            break;
        case Tool::Mesh:
            value = shape.mesh.offsets.empty() ? "" : pointOf(shape.mesh.offsets[handle_]);
            step = fmt::format("{:g} px", kPixels[static_cast<std::size_t>(step_)]);
            break;
        case Tool::Part: {
            CanvasPart part = shape.part;
            value = fmt::format("{:.5f}", edgeOf(part, handle_));
            step = fmt::format("{:g}", kShares[static_cast<std::size_t>(step_)]);
            break;
        }
        case Tool::Masks:
            if (const auto chosen = chosenOf(projection().masks, handle_))
                value = valueText(projection().masks[chosen->mask], *chosen);
            step = fmt::format("{:g} px", kPixels[static_cast<std::size_t>(step_)]);
            break;
        case Tool::Light: {
            const LightValue& light = kLightValues[handle_];
            const bool srgb = light.name == "gamma" && !projection().light.gamma;
            value = srgb ? "sRGB" : fmt::format("{:.5f}", light.read(projection().light));
            step = fmt::format("{:g}", light.steps[static_cast<std::size_t>(step_)]);
            break;
        }
    }
    return {fmt::format("{}  {}: {}", site_.outputs[output_].name, kToolNames[static_cast<std::size_t>(tool_)],
                        handles()[handle_].label),
            fmt::format("{}{}step {}", value, value.empty() ? "" : "   ", step), unsaved().empty() ? "saved" : "not saved"};
}

// Adopts the projection if it can be projected. Successive moves are undone as one.
Result<void> SiteEditor::change(Projection wanted, bool moves) {
    if (!wanted.warp.reaches(wanted.size)) return Error("nothing of the picture would be seen");
    if (!(moves && moving_)) done_.push_back({output_, projection()});
    if (done_.size() > kMostUndone) done_.erase(done_.begin());
    undone_.clear();
    moving_ = moves;
    projection() = std::move(wanted);
    return {};
}

Result<void> SiteEditor::moveBy(glm::dvec2 move, bool pixels) {
    const auto step = static_cast<std::size_t>(step_);
    Projection wanted = projection();
    WarpShape shape = wanted.warp.shape();
    switch (tool_) {
        case Tool::Corners: {
            if (!pixels) move *= kPixels[step];
            for (std::size_t i = 0; i < 4; ++i)
                if (i == handle_ || handle_ == kWhole) shape.corners[i] = rounded(shape.corners[i] + move, kPixelGrain);
            break;
        }
        case Tool::Mesh:
            if (shape.mesh.offsets.empty()) return Error("there is no mesh; choose how many points it is to have");
            if (!pixels) move *= kPixels[step];
            shape.mesh.offsets[handle_] = rounded(shape.mesh.offsets[handle_] + move, kPixelGrain);
            break;
        case Tool::Part: {
            // Converts pixels of the picture to canvas widths and heights.
            const glm::dvec2 share =
                pixels ? move / glm::dvec2(wanted.size) * (shape.part.high - shape.part.low) : move * kShares[step];
            double& edge = edgeOf(shape.part, handle_);
            edge = std::clamp(rounded(edge + (handle_ % 2 == 0 ? share.x : share.y), kShareGrain), 0.0, 1.0);
            break;
        }
        case Tool::Masks: {
            const MaskHandle chosen = TRY(chosenOf(wanted.masks, handle_));
            Mask& mask = wanted.masks[chosen.mask];
            if (!pixels) move *= kPixels[step];
            if (chosen.kind == MaskHandle::Kind::Feather)
                mask.feather = std::clamp(rounded(mask.feather + move.x - move.y, kPixelGrain), 0.0, Mask::kMaxFeather);
            else
                for (std::size_t i = 0; i < mask.polygon.size(); ++i)
                    if (i == chosen.point || chosen.kind == MaskHandle::Kind::Whole)
                        mask.polygon[i] = rounded(mask.polygon[i] + move, kPixelGrain);
            const auto isFar = [](glm::dvec2 point) {
                return std::max(std::abs(point.x), std::abs(point.y)) > Mask::kMaxCoordinate;
            };
            if (std::any_of(mask.polygon.begin(), mask.polygon.end(), isFar)) return Error("a mask so far away hides nothing");
            return change(std::move(wanted), true);
        }
        case Tool::Light: {
            const LightValue& value = kLightValues[handle_];
            // A move to the right or up increases the value.
            const double steps = pixels ? (move.x - move.y) / kPixels[1] : move.x - move.y;
            const double now = rounded(value.read(wanted.light) + steps * value.steps[step], kShareGrain);
            value.write(wanted.light, std::clamp(now, value.low, value.high));
            return change(std::move(wanted), true);
        }
    }
    wanted.warp = TRY(Warp::of(shape));
    return change(std::move(wanted), true);
}

Result<void> SiteEditor::run(const edit::Output& output) {
    return run(edit::OutputNumber{stepped(output_, output.step, site_.outputs.size())});
}
Result<void> SiteEditor::run(const edit::OutputNumber& number) {
    if (number.index >= site_.outputs.size()) return Error("there is no such output");
    moving_ = false;
    output_ = number.index;
    handle_ = std::min(handle_, handleCount() - 1);
    return {};
}
Result<void> SiteEditor::run(const edit::Choose& choose) {
    moving_ = false;
    handle_ = 0;
    tool_ = choose.tool;
    return {};
}
Result<void> SiteEditor::run(const edit::NextTool&) {
    return run(edit::Choose{static_cast<Tool>(stepped(static_cast<std::size_t>(tool_), 1, std::size(kToolNames)))});
}
Result<void> SiteEditor::run(const edit::Handle& handle) {
    moving_ = false;
    handle_ = stepped(handle_, handle.step, handleCount());
    return {};
}
Result<void> SiteEditor::run(const edit::Grasp& grasp) {
    moving_ = false;
    const std::vector<EditHandle> all = handles();
    double nearest = INFINITY;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (all[i].at && glm::distance(*all[i].at, grasp.pixel) < nearest) {
            nearest = glm::distance(*all[i].at, grasp.pixel);
            handle_ = i;
        }
    return {};
}
Result<void> SiteEditor::run(const edit::Move& move) { return moveBy(move.steps, false); }
Result<void> SiteEditor::run(const edit::MoveTo& move) {
    const EditHandle handle = handles()[handle_];
    if (!handle.at) return {};
    return moveBy(move.pixel - *handle.at, true);
}
Result<void> SiteEditor::run(const edit::Release&) {
    moving_ = false;
    return {};
}
Result<void> SiteEditor::run(const edit::StepSize& size) {
    step_ = std::clamp(step_ - size.change, 0, static_cast<int>(kPixels.size()) - 1);
    return {};
}
Result<void> SiteEditor::run(const edit::MeshPoints& mesh) {
    Projection wanted = projection();
    WarpShape shape = wanted.warp.shape();
    if (mesh.points != glm::ivec2(0) &&
        (std::min(mesh.points.x, mesh.points.y) < 2 || std::max(mesh.points.x, mesh.points.y) > WarpMesh::kMaxPoints))
        return Error(fmt::format("a mesh has 2 to {} points in each direction", WarpMesh::kMaxPoints));
    shape.mesh = shape.mesh.resampled(mesh.points);
    for (glm::dvec2& offset : shape.mesh.offsets) offset = rounded(offset, kPixelGrain);
    wanted.warp = TRY(Warp::of(shape));
    TRY(change(std::move(wanted), false));
    if (tool_ == Tool::Mesh) handle_ = 0;
    return {};
}
Result<void> SiteEditor::run(const edit::AddMask&) {
    Projection wanted = projection();
    if (wanted.masks.size() == Mask::kMax) return Error(fmt::format("an output has at most {} masks", Mask::kMax));
    const glm::dvec2 size(wanted.size);
    std::vector<glm::dvec2> polygon;
    for (const glm::dvec2 corner : rectangleCorners(1, 1)) polygon.push_back(rounded(size * (0.25 + 0.5 * corner), kPixelGrain));
    wanted.masks.push_back({.polygon = std::move(polygon)});
    TRY(change(std::move(wanted), false));
    tool_ = Tool::Masks;
    handle_ = handleCount() - 2;  // the whole mask
    return {};
}
Result<void> SiteEditor::run(const edit::MaskPoints& points) {
    if (tool_ != Tool::Masks) return Error(kNoMaskChosen);
    Projection wanted = projection();
    const MaskHandle chosen = TRY(chosenOf(wanted.masks, handle_));
    std::vector<glm::dvec2>& polygon = wanted.masks[chosen.mask].polygon;
    const auto at = polygon.begin() + static_cast<std::ptrdiff_t>(chosen.point);
    if (points.change > 0) {
        if (polygon.size() == Mask::kMaxPoints) return Error(fmt::format("a mask has at most {} points", Mask::kMaxPoints));
        polygon.insert(at + 1, rounded((*at + polygon[(chosen.point + 1) % polygon.size()]) / 2.0, kPixelGrain));
    } else if (polygon.size() > 3) {
        polygon.erase(at);
    } else {
        wanted.masks.erase(wanted.masks.begin() + static_cast<std::ptrdiff_t>(chosen.mask));
    }
    TRY(change(std::move(wanted), false));
    if (points.change > 0 && chosen.kind == MaskHandle::Kind::Point) ++handle_;
    handle_ = std::min(handle_, handleCount() - 1);
    return {};
}
Result<void> SiteEditor::run(const edit::TurnMask&) {
    if (tool_ != Tool::Masks) return Error(kNoMaskChosen);
    Projection wanted = projection();
    const MaskHandle chosen = TRY(chosenOf(wanted.masks, handle_));
    wanted.masks[chosen.mask].hidesOutside = !wanted.masks[chosen.mask].hidesOutside;
    return change(std::move(wanted), false);
}
Result<void> SiteEditor::run(const edit::Flip&) {
    Projection wanted = projection();
    WarpShape shape = wanted.warp.shape();
    shape.orientation.flip = static_cast<Orientation::Flip>((static_cast<int>(shape.orientation.flip) + 1) % 3);
    wanted.warp = TRY(Warp::of(shape));
    return change(std::move(wanted), false);
}
Result<void> SiteEditor::run(const edit::Turn&) {
    Projection wanted = projection();
    WarpShape shape = wanted.warp.shape();
    shape.orientation.quarterTurns = (shape.orientation.quarterTurns + 1) % 4;
    wanted.warp = TRY(Warp::of(shape));
    return change(std::move(wanted), false);
}
Result<void> SiteEditor::run(const edit::Reset&) {
    Projection wanted = projection();
    WarpShape shape = wanted.warp.shape();
    switch (tool_) {
        case Tool::Corners:
            shape.corners = rectangleCorners(wanted.size.x, wanted.size.y);
            break;
        case Tool::Mesh:
            std::fill(shape.mesh.offsets.begin(), shape.mesh.offsets.end(), glm::dvec2(0));
            break;
        case Tool::Part:
            shape.part = {};
            break;
        case Tool::Masks:
            std::erase_if(wanted.masks, [](const Mask& mask) { return !mask.polygon.empty(); });
            handle_ = 0;
            break;
        case Tool::Light:
            // Only the file changes the colour table and `dither`.
            wanted.light.gamma = ProjectorLight().gamma;
            wanted.light.blackLevel = ProjectorLight().blackLevel;
            wanted.light.white = ProjectorLight().white;
            wanted.light.brightness = ProjectorLight().brightness;
            break;
    }
    wanted.warp = TRY(Warp::of(shape));
    return change(std::move(wanted), false);
}
Result<void> SiteEditor::run(const edit::Picture& picture) {
    constexpr std::size_t kPictures = static_cast<std::size_t>(TestPicture::Identify) + 1;
    picture_ = static_cast<TestPicture>(stepped(static_cast<std::size_t>(picture_), picture.step, kPictures));
    return {};
}
Result<void> SiteEditor::run(const edit::Show& show) {
    picture_ = show.picture;
    return {};
}
Result<void> SiteEditor::run(const edit::Undo&) {
    if (done_.empty()) return Error("there is nothing to undo");
    swapWith(done_, undone_);
    return {};
}
Result<void> SiteEditor::run(const edit::Redo&) {
    if (undone_.empty()) return Error("there is nothing to redo");
    swapWith(undone_, done_);
    return {};
}

void SiteEditor::swapWith(std::vector<Step>& from, std::vector<Step>& to) {
    moving_ = false;
    Step step = std::move(from.back());
    from.pop_back();
    output_ = step.output;
    std::swap(projection(), step.before);
    to.push_back(std::move(step));
    handle_ = std::min(handle_, handleCount() - 1);
}

std::vector<SiteEditor::Change> SiteEditor::unsaved() const {
    std::vector<Change> changes;
    for (std::size_t i = 0; i < site_.outputs.size(); ++i)
        for (Change& change : projectionChanges(saved_[i], site_.outputs[i].projection, i)) changes.push_back(std::move(change));
    return changes;
}

void SiteEditor::adopt(const std::vector<Projection>& projections) {
    for (std::size_t i = 0; i < site_.outputs.size(); ++i) site_.outputs[i].projection = projections[i];
    saved();
    done_.clear();
    undone_.clear();
    moving_ = false;
    handle_ = std::min(handle_, handleCount() - 1);
}

void SiteEditor::saved() {
    saved_.clear();
    for (const Output& output : site_.outputs) saved_.push_back(output.projection);
}

}  // namespace fantascope::show
