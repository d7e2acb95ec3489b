#include "vision/warp_fit.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <opencv2/calib3d.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace fantascope::vision {
namespace {

// About so many patches cover what the projector lights.
constexpr double kPatches = 4000;
constexpr int kSmallestPatch = 3, kLargestPatch = 16;
// A patch needs this share of its pixels known, and its pixels this close to a plane, in projector
// pixels or as a share of the patch's width there.
constexpr double kKnownShare = 0.6, kStep = 1, kStepShare = 0.3;
constexpr std::size_t kFewestPoints = 30;
// Points this near a plane lie on it, in projector pixels. If this share of them does, the surface
// is flat and the rest is something else.
constexpr double kOnPlane = 1.0, kFlatShare = 0.6;
// Of points that belong together, those farther off than so many deviations are left out, but never
// nearer ones than this.
constexpr double kOutlier = 4, kAlwaysNear = 0.3;
// How far beyond the picture's edge points still shape the mesh, as a share of its side.
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

std::vector<double> distancesTo(const Homography& keystone, const std::vector<Sample>& samples) {
    std::vector<double> distances;
    for (const Sample& sample : samples) distances.push_back(glm::distance(keystone(sample.onPicture), sample.projector));
    return distances;
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
    cv::findHomography(from, to, cv::RANSAC, kOnPlane, near, kTrials, kSure);
    std::vector<bool> on(samples.size(), false);
    for (std::size_t i = 0; i < near.size(); ++i) on[i] = near[i] != 0;
    return on;
}

// Leaves out what is far off, and says which samples still count.
std::vector<bool> withoutOutliers(const std::vector<double>& distances, const std::vector<bool>& counts) {
    std::vector<double> counted;
    for (std::size_t i = 0; i < distances.size(); ++i)
        if (counts[i]) counted.push_back(distances[i]);
    const double limit = std::max(kAlwaysNear, kOutlier * deviationOf(std::move(counted)));
    std::vector<bool> near(distances.size());
    for (std::size_t i = 0; i < distances.size(); ++i) near[i] = distances[i] <= limit;
    return near;
}

struct Quality {
    double rms = 0, max = 0;
    std::size_t points = 0;
};

Quality qualityOf(const std::vector<Sample>& samples, const std::vector<double>& distances, const std::vector<bool>& counts) {
    Quality quality;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!counts[i] || !samples[i].inside) continue;
        quality.rms += distances[i] * distances[i];
        quality.max = std::max(quality.max, distances[i]);
        ++quality.points;
    }
    quality.rms = std::sqrt(quality.rms / static_cast<double>(std::max<std::size_t>(1, quality.points)));
    return quality;
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

    std::vector<double> distancesTo(const WarpMesh& mesh) const {
        std::vector<double> distances;
        for (const Sample& sample : samples_)
            distances.push_back(glm::distance(keystone_(sample.onPicture) + mesh.offsetAt(sample.onPicture), sample.projector));
        return distances;
    }

private:
    int at(int x, int y) const { return y * nodes_.x + x; }

    const std::vector<Sample>& samples_;
    const Homography& keystone_;
    glm::ivec2 nodes_;
};

// So many nodes that a cell has a few points.
glm::ivec2 nodesFor(std::size_t points, glm::dvec2 size) {
    const double cells = std::max(1.0, static_cast<double>(points) / kPointsOfCell), aspect = size.x / size.y;
    const glm::dvec2 wanted(std::sqrt(cells * aspect), std::sqrt(cells / aspect));
    return glm::clamp(glm::ivec2(glm::round(wanted)) + 1, glm::ivec2(kFewestNodes), glm::ivec2(kMostNodes));
}

// The plane through a patch's known pixels by least squares; nothing where they are too few or too
// far from it.
std::optional<SharedPoint> pointOf(const ProjectorMap& map, glm::ivec2 corner, int side) {
    const double middle = side / 2.0;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    int known = 0;
    const auto forKnown = [&](const auto& use) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                if (map.isKnown(corner.x + x, corner.y + y))
                    use(Eigen::Vector3d(1, x + 0.5 - middle, y + 0.5 - middle), map.at.at(corner.x + x, corner.y + y));
    };
    forKnown([&](const Eigen::Vector3d& place, glm::vec2 at) {
        normal += place * place.transpose();
        right += place * Eigen::RowVector2d(at.x, at.y);
        ++known;
    });
    if (known < kKnownShare * side * side) return std::nullopt;
    const Eigen::Matrix<double, 3, 2> plane = normal.ldlt().solve(right);
    const double step = std::max(kStep, kStepShare * side * std::sqrt(std::abs(plane.bottomRows<2>().determinant())));
    bool near = true;
    forKnown([&](const Eigen::Vector3d& place, glm::vec2 at) {
        const Eigen::RowVector2d off = place.transpose() * plane - Eigen::RowVector2d(at.x, at.y);
        near = near && off.norm() <= step;
    });
    if (!near) return std::nullopt;
    return SharedPoint{glm::dvec2(corner) + middle, {plane(0, 0), plane(0, 1)}};
}

}  // namespace

std::vector<SharedPoint> sharedPoints(const ProjectorMap& map) {
    const int side =
        std::clamp(static_cast<int>(std::sqrt(static_cast<double>(map.lit) / kPatches)), kSmallestPatch, kLargestPatch);
    std::vector<SharedPoint> points;
    for (int y = 0; y + side <= map.at.height(); y += side)
        for (int x = 0; x + side <= map.at.width(); x += side)
            if (const auto point = pointOf(map, {x, y}, side)) points.push_back(*point);
    return points;
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
        Sample sample{warp.pictureFromCanvas()(canvasFromView(viewOf(wanted.camera, point.camera))), point.projector, false};
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

    std::vector<bool> counts = onOnePlane(samples);
    const auto onPlane = static_cast<double>(std::count(counts.begin(), counts.end(), true));
    fit.flat = onPlane >= kFlatShare * static_cast<double>(samples.size());
    if (!fit.flat) counts.assign(samples.size(), true);
    std::optional<Homography> keystone = fittedHomography(samples, counts);
    for (int round = 0; keystone && round < kRounds; ++round) {
        counts = withoutOutliers(distancesTo(*keystone, samples), counts);
        keystone = fittedHomography(samples, counts);
    }
    if (!keystone) return Error("the points that projector and camera share lie on one line; turn the camera towards the wall");
    Quality quality = qualityOf(samples, distancesTo(*keystone, samples), counts);
    fit.keystoneRms = quality.rms, fit.keystoneMax = quality.max;
    for (std::size_t i = 0; i < 4; ++i) fit.shape.corners[i] = (*keystone)(rectangleCorners(1, 1)[i]);
    if (!fit.flat) {
        const auto& c = fit.shape.corners;
        const MeshFit mesh(samples, *keystone, nodesFor(inside, {glm::distance(c[0], c[1]), glm::distance(c[0], c[3])}));
        counts.assign(samples.size(), true);
        for (int round = 0; round < kRounds; ++round) {
            fit.shape.mesh = mesh.over(counts);
            counts = withoutOutliers(mesh.distancesTo(fit.shape.mesh), counts);
        }
        quality = qualityOf(samples, mesh.distancesTo(fit.shape.mesh), counts);
    }
    TRY(Warp::of(fit.shape));
    fit.rms = quality.rms, fit.max = quality.max, fit.points = quality.points;
    fit.leftOut = 1 - static_cast<double>(quality.points) / static_cast<double>(inside);
    return fit;
}

}  // namespace fantascope::vision
