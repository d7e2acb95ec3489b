#include "vision/warp_fit.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <opencv2/calib3d.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace fantascope::vision {
namespace {

// About so many patches cover what the projector lights.
constexpr double kPatches = 4000;
constexpr int kSmallestPatch = 3, kLargestPatch = 16;
// A patch needs this share of its pixels known, and its pixels this close to a plane, in projector
// pixels or as a share of the patch's width there.
constexpr double kKnownShare = 0.6, kStep = 1, kStepShare = 0.3;
constexpr std::size_t kFewestPoints = 30;
constexpr double kMostBlur = 9;  // s^2, camera pixels
// Points this near a plane lie on it, in projector pixels. If this share of them does, the surface
// is flat and the rest is something else.
constexpr double kOnPlane = 1.0, kFlatShare = 0.6;
// A keystone is enough if its means over neighbours miss by less, in projector pixels or as a
// multiple of the points' noise. On flat walls of brick, grass and gravel it was .4 to .7 of the
// noise, on uneven ground 3 to 7 times.
constexpr double kFlatRms = 0.1, kFlatNoise = 1.2;
// Noisy points may be so many deviations from it.
constexpr double kPlaneNoise = 3;
// Of points that belong together, those farther off than so many deviations are left out, but never
// nearer ones than this.
constexpr double kOutlier = 4, kAlwaysNear = 0.3;
// Points up to so far beyond the picture's edge count for the mesh, as a share of its side.
constexpr double kMargin = 0.05;
constexpr int kFewestNodes = 5, kMostNodes = 65;
constexpr double kPointsOfCell = 4;
// The weight of the mesh's bending against its points: enough to fill gaps, too little to flatten
// bumps.
constexpr double kBending = 0.02;
constexpr int kRounds = 6;

// A point as the fit sees it.
struct Sample {
    glm::dvec2 onPicture{0.0};  // 0..1 from the picture's top left
    glm::dvec2 projector{0.0};
    glm::ivec2 patch{0};
    bool inside = false;  // the picture
};

// The direction through a camera pixel, where its axis meets 1.
glm::dvec2 viewOf(const CameraModel& camera, glm::dvec2 pixel) {
    CameraModel lens = camera;
    lens.pose = Pose{};
    const glm::dvec3 direction = lens.rayThrough(pixel).direction;
    return glm::dvec2(direction) / direction.z;
}

double deviationOf(std::vector<double> distances) {
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle / 1.1774;  // the median of a Rayleigh distribution is 1.1774 deviations
}

// Least squares over the samples that count, by Levenberg-Marquardt from a linear start.
std::optional<Homography> fittedHomography(const std::vector<Sample>& samples, const std::vector<bool>& counts) {
    std::vector<cv::Point2d> from, to;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (counts[i]) {
            from.emplace_back(samples[i].onPicture.x, samples[i].onPicture.y);
            to.emplace_back(samples[i].projector.x, samples[i].projector.y);
        }
    if (from.size() < 4) return std::nullopt;
    const cv::Mat found = cv::findHomography(from, to, 0);
    if (found.empty()) return std::nullopt;
    glm::dmat3 matrix;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) matrix[column][row] = found.at<double>(row, column);
    return Homography(matrix);
}

using Residuals = std::vector<glm::dvec2>;  // of all samples, projector pixels

Residuals residualsOf(const Homography& keystone, const std::vector<Sample>& samples) {
    Residuals residuals;
    for (const Sample& sample : samples) residuals.push_back(keystone(sample.onPicture) - sample.projector);
    return residuals;
}

// The standard deviation of single points on a smooth surface, from the distance between a point
// and the mean of its four neighbours.
double noiseOf(const std::vector<Sample>& samples) {
    std::map<std::pair<int, int>, glm::dvec2> points;
    for (const Sample& sample : samples) points[{sample.patch.x, sample.patch.y}] = sample.projector;
    std::vector<double> distances;
    for (const auto& [patch, at] : points) {
        glm::dvec2 sum(0);
        int count = 0;
        for (const glm::ivec2 step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}})
            if (const auto next = points.find({patch.first + step.x, patch.second + step.y}); next != points.end())
                sum += next->second, ++count;
        if (count == 4) distances.push_back(glm::distance(at, sum / 4.0));
    }
    return distances.empty() ? 0 : deviationOf(std::move(distances)) / std::sqrt(1 + 1 / 4.0);
}

// The samples on the plane that most of them lie on.
std::vector<bool> onOnePlane(const std::vector<Sample>& samples) {
    std::vector<cv::Point2d> from, to;
    for (const Sample& sample : samples) {
        from.emplace_back(sample.onPicture.x, sample.onPicture.y);
        to.emplace_back(sample.projector.x, sample.projector.y);
    }
    std::vector<unsigned char> near;
    constexpr int kTrials = 5000;
    constexpr double kSure = 0.9999;
    cv::findHomography(from, to, cv::RANSAC, std::max(kOnPlane, kPlaneNoise * noiseOf(samples)), near, kTrials, kSure);
    std::vector<bool> on(samples.size(), false);
    for (std::size_t i = 0; i < near.size(); ++i) on[i] = near[i] != 0;
    return on;
}

// Leaves out what is far off, and says which samples still count.
std::vector<bool> withoutOutliers(const Residuals& residuals, const std::vector<bool>& counts) {
    std::vector<double> counted;
    for (std::size_t i = 0; i < residuals.size(); ++i)
        if (counts[i]) counted.push_back(glm::length(residuals[i]));
    const double limit = std::max(kAlwaysNear, kOutlier * deviationOf(std::move(counted)));
    std::vector<bool> near(residuals.size());
    for (std::size_t i = 0; i < residuals.size(); ++i) near[i] = glm::length(residuals[i]) <= limit;
    return near;
}

struct Quality {
    double rms = 0, max = 0;
    std::size_t points = 0;
};

Quality qualityOf(const std::vector<Sample>& samples, const Residuals& residuals, const std::vector<bool>& counts) {
    std::map<std::pair<int, int>, glm::dvec2> counted;
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (counts[i]) counted[{samples[i].patch.x, samples[i].patch.y}] = residuals[i];
    Quality quality;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!counts[i] || !samples[i].inside) continue;
        glm::dvec2 sum(0);
        int count = 0;
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x)
                if (const auto at = counted.find({samples[i].patch.x + x, samples[i].patch.y + y}); at != counted.end())
                    sum += at->second, ++count;
        const double off = glm::length(sum / double(count));
        quality.rms += off * off;
        quality.max = std::max(quality.max, off);
        ++quality.points;
    }
    quality.rms = std::sqrt(quality.rms / static_cast<double>(std::max<std::size_t>(1, quality.points)));
    return quality;
}

struct KeystoneFit {
    Homography keystone;
    std::vector<bool> counts;  // by sample
    Quality quality;
};

// The keystone by least squares over the samples that count, again and again without those that are
// far off. Nothing if the samples lie on one line.
std::optional<KeystoneFit> fittedKeystone(const std::vector<Sample>& samples, std::vector<bool> counts) {
    auto keystone = fittedHomography(samples, counts);
    for (int round = 0; keystone && round < kRounds; ++round) {
        counts = withoutOutliers(residualsOf(*keystone, samples), counts);
        keystone = fittedHomography(samples, counts);
    }
    if (!keystone) return std::nullopt;
    const Quality quality = qualityOf(samples, residualsOf(*keystone, samples), counts);
    return KeystoneFit{*keystone, std::move(counts), quality};
}

// A lattice whose bilinear interpolation is the mesh.
class MeshFit {
public:
    MeshFit(const std::vector<Sample>& samples, const Homography& keystone, glm::ivec2 nodes)
        : samples_(samples), keystone_(keystone), nodes_(nodes) {}

    // The mesh by least squares over the samples that count, with little bending.
    WarpMesh over(const std::vector<bool>& counts) const {
        using Entry = Eigen::Triplet<double>;
        std::vector<Entry> entries;
        std::vector<glm::dvec2> wanted;
        const auto addRow = [&](std::initializer_list<std::pair<int, double>> terms, glm::dvec2 value) {
            for (const auto& [node, weight] : terms) entries.emplace_back(static_cast<int>(wanted.size()), node, weight);
            wanted.push_back(value);
        };
        double counted = 0;
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            if (!counts[i]) continue;
            const glm::dvec2 cells = glm::clamp(samples_[i].onPicture, 0.0, 1.0) * glm::dvec2(nodes_ - 1);
            const glm::ivec2 cell = glm::min(glm::ivec2(cells), nodes_ - 2);
            const glm::dvec2 t = cells - glm::dvec2(cell);
            addRow({{at(cell.x, cell.y), (1 - t.x) * (1 - t.y)},
                    {at(cell.x + 1, cell.y), t.x * (1 - t.y)},
                    {at(cell.x, cell.y + 1), (1 - t.x) * t.y},
                    {at(cell.x + 1, cell.y + 1), t.x * t.y}},
                   samples_[i].projector - keystone_(samples_[i].onPicture));
            ++counted;
        }
        const double bending = std::sqrt(kBending * std::max(1.0, counted / (nodes_.x * nodes_.y)));
        for (int y = 0; y < nodes_.y; ++y)
            for (int x = 0; x < nodes_.x; ++x) {
                if (x > 0 && x + 1 < nodes_.x)
                    addRow({{at(x - 1, y), bending}, {at(x, y), -2 * bending}, {at(x + 1, y), bending}}, {0, 0});
                if (y > 0 && y + 1 < nodes_.y)
                    addRow({{at(x, y - 1), bending}, {at(x, y), -2 * bending}, {at(x, y + 1), bending}}, {0, 0});
            }
        Eigen::SparseMatrix<double> rows(static_cast<int>(wanted.size()), nodes_.x * nodes_.y);
        rows.setFromTriplets(entries.begin(), entries.end());
        Eigen::MatrixX2d values(static_cast<int>(wanted.size()), 2);
        for (std::size_t i = 0; i < wanted.size(); ++i) values.row(static_cast<int>(i)) << wanted[i].x, wanted[i].y;
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(rows.transpose() * rows);
        const Eigen::MatrixX2d offsets = solver.solve(rows.transpose() * values);
        WarpMesh mesh{WarpMesh::Between::Straight, nodes_, {}};
        for (int i = 0; i < offsets.rows(); ++i) mesh.offsets.emplace_back(offsets(i, 0), offsets(i, 1));
        return mesh;
    }

    Residuals residualsOf(const WarpMesh& mesh) const {
        Residuals residuals;
        for (const Sample& sample : samples_)
            residuals.push_back(keystone_(sample.onPicture) + mesh.offsetAt(sample.onPicture) - sample.projector);
        return residuals;
    }

private:
    int at(int x, int y) const { return y * nodes_.x + x; }

    const std::vector<Sample>& samples_;
    const Homography& keystone_;
    glm::ivec2 nodes_;
};

// The number of nodes with which a cell has a few points.
glm::ivec2 nodesFor(std::size_t points, glm::dvec2 size) {
    const double cells = std::max(1.0, static_cast<double>(points) / kPointsOfCell), aspect = size.x / size.y;
    const glm::dvec2 wanted(std::sqrt(cells * aspect), std::sqrt(cells / aspect));
    return glm::clamp(glm::ivec2(glm::round(wanted)) + 1, glm::ivec2(kFewestNodes), glm::ivec2(kMostNodes));
}

// The slope of the light divided by the light, per camera pixel across and down; 0 at the light's
// edge. The five-point difference keeps the slopes of fine texture.
Image<glm::vec2> slopesOf(const GreyImage& light) {
    constexpr int kReach = 2;
    Image<glm::vec2> slopes(light.width(), light.height(), glm::vec2(0));
    for (int y = kReach; y + kReach < light.height(); ++y)
        for (int x = kReach; x + kReach < light.width(); ++x) {
            bool lit = true;
            const auto slope = [&](int dx, int dy) {
                std::array<float, 2 * kReach + 1> along{};
                for (int i = -kReach; i <= kReach; ++i) {
                    along[static_cast<std::size_t>(i + kReach)] = light.at(x + i * dx, y + i * dy);
                    lit = lit && light.at(x + i * dx, y + i * dy) > 0;
                }
                return (along[0] - 8 * along[1] + 8 * along[3] - along[4]) / (12 * along[2]);
            };
            const glm::vec2 both(slope(1, 0), slope(0, 1));
            if (lit) slopes.at(x, y) = both;
        }
    return slopes;
}

// Square patches of a map, each with the plane through its known pixels by least squares.
class Patches {
public:
    Patches(const ProjectorMap& map, int side) : map_(map), side_(side), slopes_(slopesOf(map.light)) {}

    // The camera's blur s^2, in camera pixels, by least squares over all pixels. Blur moves what a
    // pixel saw by s^2 * slope. A part of that lies in the patch's plane and is not noticed, so the
    // rest of the slopes is compared with the pixels' distances from the plane.
    double blur() const {
        double product = 0, square = 0;
        forEach([&](glm::ivec2 corner) {
            const auto plane = planeOf(corner, 0);
            if (!plane) return;
            Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
            Plane right = Plane::Zero();
            const auto drawnBy = [&](glm::vec2 slope) {
                return Eigen::RowVector2d(Eigen::RowVector2d(slope.x, slope.y) * plane->bottomRows<2>());
            };
            forKnown(corner, 0, [&](const Place& place, const Eigen::RowVector2d&, glm::vec2 slope) {
                normal += place * place.transpose();
                right += place * drawnBy(slope);
            });
            const Plane drawn = normal.ldlt().solve(right);
            forKnown(corner, 0, [&](const Place& place, const Eigen::RowVector2d& at, glm::vec2 slope) {
                const Eigen::RowVector2d off = at - place.transpose() * *plane;
                if (off.norm() > stepOf(*plane)) return;
                const Eigen::RowVector2d left = drawnBy(slope) - place.transpose() * drawn;
                product += off.dot(left), square += left.squaredNorm();
            });
        });
        return square > 0 ? std::clamp(product / square, 0.0, kMostBlur) : 0;
    }

    std::vector<SharedPoint> points(double blur) const {
        std::vector<SharedPoint> points;
        forEach([&](glm::ivec2 corner) {
            const auto plane = planeOf(corner, blur);
            if (!plane) return;
            bool near = true;
            forKnown(corner, blur, [&](const Place& place, const Eigen::RowVector2d& at, glm::vec2) {
                near = near && (at - place.transpose() * *plane).norm() <= stepOf(*plane);
            });
            if (near) points.push_back({glm::dvec2(corner) + side_ / 2.0, {(*plane)(0, 0), (*plane)(0, 1)}, corner / side_});
        });
        return points;
    }

private:
    using Place = Eigen::Vector3d;  // 1, then the place from the patch's middle, camera pixels
    using Plane = Eigen::Matrix<double, 3, 2>;

    template <class Use>
    void forEach(const Use& use) const {
        for (int y = 0; y + side_ <= map_.at.height(); y += side_)
            for (int x = 0; x + side_ <= map_.at.width(); x += side_) use(glm::ivec2(x, y));
    }
    // What a pixel saw lies beside its middle by blur * slope.
    template <class Use>
    void forKnown(glm::ivec2 corner, double blur, const Use& use) const {
        const double middle = side_ / 2.0;
        for (int y = 0; y < side_; ++y)
            for (int x = 0; x < side_; ++x) {
                const glm::ivec2 pixel = corner + glm::ivec2(x, y);
                if (!map_.isKnown(pixel.x, pixel.y)) continue;
                const glm::vec2 at = map_.at.at(pixel.x, pixel.y), slope = slopes_.at(pixel.x, pixel.y);
                use(Place(1, x + 0.5 - middle + blur * slope.x, y + 0.5 - middle + blur * slope.y),
                    Eigen::RowVector2d(at.x, at.y), slope);
            }
    }
    // The distance from a patch's plane, in projector pixels, that is no step of the surface.
    double stepOf(const Plane& plane) const {
        return std::max(kStep, kStepShare * side_ * std::sqrt(std::abs(plane.bottomRows<2>().determinant())));
    }
    std::optional<Plane> planeOf(glm::ivec2 corner, double blur) const {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Plane right = Plane::Zero();
        int known = 0;
        forKnown(corner, blur, [&](const Place& place, const Eigen::RowVector2d& at, glm::vec2) {
            normal += place * place.transpose();
            right += place * at;
            ++known;
        });
        if (known < kKnownShare * side_ * side_) return std::nullopt;
        return Plane(normal.ldlt().solve(right));
    }

    const ProjectorMap& map_;
    const int side_;
    const Image<glm::vec2> slopes_;
};

}  // namespace

std::vector<SharedPoint> sharedPoints(const ProjectorMap& map) {
    const double side = std::sqrt(static_cast<double>(map.lit) / kPatches);
    const Patches patches(map, std::clamp(static_cast<int>(side), kSmallestPatch, kLargestPatch));
    return patches.points(patches.blur());
}

Result<WarpFit> fitWarp(const std::vector<SharedPoint>& points, const WantedPlace& wanted, const WarpShape& now) {
    WarpFit fit;
    fit.shape = now;
    fit.shape.mesh = {};
    const Warp warp = TRY(Warp::of(fit.shape));
    std::array<glm::dvec2, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = viewOf(wanted.camera, wanted.corners[i]);
    const Homography canvasFromView = TRY(Homography::fromCorners(corners, rectangleCorners(1, 1)));

    std::vector<Sample> samples;
    std::size_t inside = 0;
    for (const SharedPoint& point : points) {
        Sample sample{warp.pictureFromCanvas()(canvasFromView(viewOf(wanted.camera, point.camera))), point.projector, point.patch,
                      false};
        const glm::dvec2 beyond = glm::max(-sample.onPicture, sample.onPicture - 1.0);
        sample.inside = std::max(beyond.x, beyond.y) <= 0;
        inside += sample.inside ? 1 : 0;
        if (std::max(beyond.x, beyond.y) <= kMargin) samples.push_back(sample);
    }
    if (inside < kFewestPoints)
        return Error(
            fmt::format("only {} points of the wanted place are lit by this output and seen by the camera, {} are needed; "
                        "turn the projector, the camera or the wanted corners so that they meet",
                        inside, kFewestPoints));

    const auto planar = fittedKeystone(samples, onOnePlane(samples));
    const auto onPlane = planar ? static_cast<double>(std::ranges::count(planar->counts, true)) : 0;
    fit.flat = onPlane >= kFlatShare * static_cast<double>(samples.size()) &&
               planar->quality.rms <= std::max(kFlatRms, kFlatNoise * noiseOf(samples));
    const auto best = fit.flat ? planar : fittedKeystone(samples, std::vector<bool>(samples.size(), true));
    if (!best) return Error("the points that projector and camera share lie on one line; turn the camera towards the wall");
    const Homography& keystone = best->keystone;
    Quality quality = best->quality;
    fit.keystoneRms = quality.rms, fit.keystoneMax = quality.max;
    for (std::size_t i = 0; i < 4; ++i) fit.shape.corners[i] = keystone(rectangleCorners(1, 1)[i]);
    if (!fit.flat) {
        const auto& c = fit.shape.corners;
        const MeshFit mesh(samples, keystone, nodesFor(inside, {glm::distance(c[0], c[1]), glm::distance(c[0], c[3])}));
        std::vector<bool> counts(samples.size(), true);
        for (int round = 0; round < kRounds; ++round) {
            fit.shape.mesh = mesh.over(counts);
            counts = withoutOutliers(mesh.residualsOf(fit.shape.mesh), counts);
        }
        quality = qualityOf(samples, mesh.residualsOf(fit.shape.mesh), counts);
    }
    TRY(Warp::of(fit.shape));
    fit.rms = quality.rms, fit.max = quality.max, fit.points = quality.points;
    fit.leftOut = 1 - static_cast<double>(quality.points) / static_cast<double>(inside);
    return fit;
}

}  // namespace fantascope::vision
