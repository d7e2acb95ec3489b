#include "media/colour_cube.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <string>

namespace fantascope {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Result<ColourCube> readText(const std::string& text) {
    const ScratchFolder folder;
    return ColourCube::read(folder.file("table.cube", text));
}
std::string refusal(const std::string& text) {
    const auto cube = readText(text);
    return cube ? "accepted" : cube.error().message();
}

// A table of `side` points in each direction with the results of `colourOf`; red varies fastest.
template <class ColourOf>
std::string tableOf(int side, ColourOf colourOf) {
    std::string text = fmt::format("# made by a test\r\nTITLE \"a table\"\r\nLUT_3D_SIZE {}\r\n\r\n", side);
    for (int blue = 0; blue < side; ++blue)
        for (int green = 0; green < side; ++green)
            for (int red = 0; red < side; ++red) {
                const glm::vec3 colour = colourOf(glm::vec3(red, green, blue) / static_cast<float>(side - 1));
                text += fmt::format("{:.6f}\t{:.6f} {:.6f}\r\n", colour.r, colour.g, colour.b);
            }
    return text;
}

// Example failure: blue varies fastest, as in other formats.
TEST(ColourCube, finds_each_colour_in_its_place_and_goes_straight_in_between) {
    const auto linear = [](glm::vec3 c) { return glm::vec3(0.2f + 0.5f * c.r, 0.9f * c.g, c.b * 0.3f + 0.4f * c.r); };
    const auto cube = readText(tableOf(5, linear));
    ASSERT_TRUE(cube) << cube.error().message();
    EXPECT_EQ(cube->side, 5);
    for (const glm::vec3 colour : {glm::vec3(0), glm::vec3(1), glm::vec3(0.25f, 0.5f, 0.75f), glm::vec3(0.1f, 0.93f, 0.47f)})
        EXPECT_LT(glm::distance(cube->at(colour), linear(colour)), 1e-5f);
    EXPECT_LT(glm::distance(cube->at({-3, 2, 0.5f}), linear({0, 1, 0.5f})), 1e-5f)
        << "beyond its range it goes on as at the edge";
}

TEST(ColourCube, heeds_its_domain) {
    const std::string text = tableOf(2, [](glm::vec3 c) { return c; });
    const auto cube = readText("DOMAIN_MIN 0 0 0\nDOMAIN_MAX 2 2 4\n" + text);
    ASSERT_TRUE(cube) << cube.error().message();
    EXPECT_LT(glm::distance(cube->at({1, 2, 1}), glm::vec3(0.5f, 1, 0.25f)), 1e-6f);
}

TEST(ColourCube, refuses_what_is_no_table_and_says_where) {
    const std::string whole = tableOf(3, [](glm::vec3 c) { return c; });
    EXPECT_EQ(refusal(whole), "accepted");
    EXPECT_THAT(refusal(whole.substr(0, whole.rfind("0.500000\t1.0"))), HasSubstr("is cut off: it has 25 of 27 colours"));
    EXPECT_THAT(refusal(whole + "0 0 0\n"), HasSubstr(":32: more than the 27 colours of its size"));
    EXPECT_THAT(refusal("LUT_1D_SIZE 2\n0 0 0\n1 1 1\n"), HasSubstr(":1: a one-dimensional table"));
    EXPECT_THAT(refusal("LUT_3D_SIZE 1\n"), HasSubstr(":1: LUT_3D_SIZE is a whole number in 2 .. 256"));
    EXPECT_THAT(refusal("LUT_3D_SIZE 2\n0 0\n"), HasSubstr(":2: a colour is three numbers"));
    EXPECT_THAT(refusal("LUT_3D_SIZE 2\n0 0 nan\n"), HasSubstr(":2: a colour is three numbers"));
    EXPECT_THAT(refusal("0 0 0\n"), HasSubstr("not a .cube file"));
    EXPECT_THAT(refusal("PNG\n"), HasSubstr("a .cube file does not begin with 'PNG'"));
    EXPECT_THAT(refusal(""), HasSubstr("not a .cube file"));
    EXPECT_THAT(refusal("DOMAIN_MIN 1 1 1\nDOMAIN_MAX 1 2 2\n" + whole), HasSubstr("DOMAIN_MIN is not below DOMAIN_MAX"));
    EXPECT_THAT(ColourCube::read("nowhere.cube").error().message(), StartsWith("nowhere.cube: cannot be read"));
}

}  // namespace
}  // namespace fantascope
