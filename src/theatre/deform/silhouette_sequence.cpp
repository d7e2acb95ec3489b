#include "theatre/deform/silhouette_sequence.h"

#include "core/config/config.h"
#include "core/config/naming.h"
#include "core/file.h"
#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::size_t kMostFrames = 100'000;
constexpr std::uint32_t kMostVertices = 1'000'000;
constexpr double kFarthest = 1e6;  // pixels
constexpr double kLeastRate = 0.001, kMostRate = 1000;

// Numbers are one text, separated by spaces: a YAML list would be a hundred times as large in
// memory.
template <class Number>
Result<std::vector<Number>> readNumbers(const ConfigNode& node, Number low, Number high) {
    const std::string text = TRY(node.text());
    std::vector<Number> numbers;
    for (const char *at = text.data(), *const end = at + text.size(); at != end;) {
        if (*at == ' ') {
            ++at;
            continue;
        }
        Number number{};
        const auto [next, failure] = std::from_chars(at, end, number);
        if (failure != std::errc() || (next != end && *next != ' ') || !(number >= low && number <= high))
            return node.error(fmt::format("'{}' is no number within {} .. {}; a space separates two numbers",
                                          std::string_view(at, std::find(at, end, ' ')), low, high));
        numbers.push_back(number);
        at = next;
    }
    return numbers;
}

Result<std::vector<glm::uvec3>> readTriangles(const ConfigNode& node) {
    const std::vector<std::uint32_t> numbers = TRY(readNumbers<std::uint32_t>(node, 0, kMostVertices - 1));
    if (numbers.empty() || numbers.size() % 3 != 0)
        return node.error(fmt::format("{} numbers; each triangle takes three, the vertices at its corners", numbers.size()));
    std::vector<glm::uvec3> triangles;
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
        const glm::uvec3 triangle(numbers[i], numbers[i + 1], numbers[i + 2]);
        if (triangle.x == triangle.y || triangle.y == triangle.z || triangle.z == triangle.x)
            return node.error(fmt::format("triangle {} has the corners {}, {} and {}; they are three different vertices", i / 3,
                                          triangle.x, triangle.y, triangle.z));
        triangles.push_back(triangle);
    }
    return triangles;
}

Result<std::vector<glm::dvec2>> readVertices(const ConfigNode& node) {
    const std::vector<double> numbers = TRY(readNumbers(node, -kFarthest, kFarthest));
    if (numbers.size() % 2 != 0) return node.error(fmt::format("{} numbers; each vertex takes two, x and y", numbers.size()));
    std::vector<glm::dvec2> vertices;
    for (std::size_t i = 0; i < numbers.size(); i += 2) vertices.emplace_back(numbers[i], numbers[i + 1]);
    return vertices;
}

Result<SilhouetteSequence::Interior> readInterior(const ConfigNode& node) {
    SilhouetteSequence::Interior interior;
    ConfigFields fields(node);
    fields.read("triangles", interior.triangles, readTriangles);
    fields.read("frames", interior.vertices, [&](const ConfigNode& at) -> Result<std::vector<std::vector<glm::dvec2>>> {
        std::vector<std::vector<glm::dvec2>> frames;
        std::uint32_t last = 0;
        for (const glm::uvec3 triangle : interior.triangles) last = std::max({last, triangle.x, triangle.y, triangle.z});
        for (const ConfigNode& frame : TRY(at.items(1, kMostFrames))) {
            frames.push_back(TRY(readVertices(frame)));
            if (frames.back().size() != frames[0].size())
                return frame.error(fmt::format("{} vertices, and the first frame has {}; all have the same", frames.back().size(),
                                               frames[0].size()));
            if (!interior.triangles.empty() && frames.back().size() <= last)
                return frame.error(fmt::format("{} vertices, and a triangle has number {} for a corner; they are counted from 0",
                                               frames.back().size(), last));
        }
        return frames;
    });
    TRY(fields.finish());
    return interior;
}

Result<SilhouetteSequence> sequenceOf(const ConfigNode& root) {
    SilhouetteSequence sequence;
    ConfigFields fields(root);
    fields.header("sequence", kVersion);
    fields.number("frames_per_second", sequence.framesPerSecond, kLeastRate, kMostRate);
    fields.optional().boolean("loops", sequence.loops);
    fields.list(
        "pictures", sequence.pictures, [](const ConfigNode& node) { return node.path(); }, 1, kMostFrames);
    fields.optional().read("interior", sequence.interior,
                           [&](const ConfigNode& node) -> Result<std::optional<SilhouetteSequence::Interior>> {
                               return std::optional(TRY(readInterior(node)));
                           });
    TRY(fields.finish());
    if (sequence.interior && sequence.interior->vertices.size() != sequence.pictures.size())
        return root.error(fmt::format("the interior has {} frames, and there are {} pictures; each has one",
                                      sequence.interior->vertices.size(), sequence.pictures.size()));
    return sequence;
}

Result<void> checkPictures(const fs::path& file, const ConfigNode& root, const SilhouetteSequence& sequence) {
    glm::ivec2 first(0);
    for (std::size_t i = 0; i < sequence.pictures.size(); ++i) {
        const auto read = pictureSize(sequence.pictures[i]);
        if (!read) return namedIn(file, sequence.pictures[i], read.error());
        const glm::ivec2 size = *read;
        if (i == 0) first = size;
        if (size != first)
            return root.error(fmt::format("{} is {} x {} pixels, and the first picture {} x {}; all are of one size",
                                          sequence.pictures[i].string(), size.x, size.y, first.x, first.y));
    }
    return {};
}

}  // namespace

Result<SilhouetteSequence> readSequence(const fs::path& file) {
    const ConfigNode root = TRY(ConfigNode::load(file));
    SilhouetteSequence sequence = TRY(sequenceOf(root));
    TRY(checkPictures(file, root, sequence));
    return sequence;
}

Result<void> writeSequence(const fs::path& file, const SilhouetteSequence& sequence) {
    std::string text = fmt::format("fantascope: sequence\nversion: {}\nframes_per_second: {}\nloops: {}\npictures:\n", kVersion,
                                   shortest(sequence.framesPerSecond), sequence.loops);
    const auto add = [&]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    };
    for (const fs::path& picture : sequence.pictures) add("  - {}\n", fantascope::quoted(TRY(relativeTo(file, picture))));
    if (sequence.interior) {
        const auto list = [&](const auto& points, int size) {
            for (const auto& point : points)
                for (int i = 0; i < size; ++i) add(" {}", shortest(point[i]));
            text += '\n';
        };
        add("interior:\n  triangles:");
        list(sequence.interior->triangles, 3);
        add("  frames:\n");
        for (const auto& vertices : sequence.interior->vertices) {
            add("    -");
            list(vertices, 2);
        }
    }
    // The text is read back first, so that an unreadable one never replaces a good file.
    if (const auto readable = sequenceOf(TRY(ConfigNode::parse(text, file))); !readable)
        return readable.error().in("not written, as it could not be read again");
    return writeFile(file, text);
}

}  // namespace fantascope::theatre
