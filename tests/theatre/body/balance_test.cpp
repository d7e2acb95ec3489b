#include "theatre/body/balance.h"

#include "theatre/body/body_mesh.h"

#include "core/geometry.h"
#include "core/random.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

Contacts on(std::vector<Contact> discs) {
    Contacts contacts{std::move(discs), true};
    contacts.support.build(contacts.discs);
    return contacts;
}
double supportMargin(const Contacts& contacts, const dvec3& massCentre) { return contacts.support.margin(massCentre); }
double supportArea(const Contacts& contacts) { return contacts.support.area(); }

TEST(SupportMargin, of_a_square_is_the_distance_to_its_nearest_side) {
    const Contacts square = on({{{0, 0}, 0}, {{1, 0}, 0}, {{1, 1}, 0}, {{0, 1}, 0}, {{0.5, 0.4}, 0}});
    EXPECT_NEAR(supportMargin(square, {0.5, 9, 0.5}), 0.5, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.3, 1, 0.6}), 0.3, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.3, 1, 0.9}), 0.1, 1e-9);
    EXPECT_NEAR(supportMargin(square, {1, 1, 0.5}), 0, 1e-9);
    EXPECT_NEAR(supportMargin(square, {1.2, 1, 0.5}), -0.2, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.5, 1, -0.4}), -0.4, 1e-9);
    // Beyond a corner it is the distance to the corner.
    EXPECT_NEAR(supportMargin(square, {1.3, 1, 1.4}), -0.5, 1e-9);
    EXPECT_NEAR(supportArea(square), 1, 1e-9);
}

TEST(SupportMargin, of_feet_reaches_around_their_discs) {
    const Contacts square = on({{{0, 0}, 0.1}, {{1, 0}, 0.1}, {{1, 1}, 0.1}, {{0, 1}, 0.1}});
    EXPECT_NEAR(supportMargin(square, {0.5, 1, 0.9}), 0.2, 1e-9);
    EXPECT_NEAR(supportArea(square), 1 + 0.4 + std::numbers::pi * 0.01, 1e-9);
}

TEST(SupportMargin, of_one_contact_is_of_its_disc) {
    const Contacts disc = on({{{2, 3}, 0.2}});
    EXPECT_NEAR(supportMargin(disc, {2, 1, 3}), 0.2, 1e-9);
    EXPECT_NEAR(supportMargin(disc, {2.09, 1, 3.12}), 0.05, 1e-9);
    EXPECT_NEAR(supportMargin(disc, {2.3, 1, 3.4}), -0.3, 1e-9);
    EXPECT_NEAR(supportArea(disc), std::numbers::pi * 0.04, 1e-9);
}

TEST(SupportMargin, of_two_contacts_is_of_the_band_around) {
    const Contacts band = on({{{0, 0}, 0.05}, {{2, 0}, 0.05}});
    EXPECT_NEAR(supportMargin(band, {1, 1, 0}), 0.05, 1e-9);
    EXPECT_NEAR(supportMargin(band, {1, 1, 0.03}), 0.02, 1e-9);
    EXPECT_NEAR(supportMargin(band, {0.4, 1, -0.5}), -0.45, 1e-9);
    EXPECT_NEAR(supportMargin(band, {2.35, 1, 0}), -0.3, 1e-9);
    EXPECT_NEAR(supportArea(band), 2 * 0.1 + std::numbers::pi * 0.0025, 1e-9);
    // Points alone: nothing to stand on.
    EXPECT_NEAR(supportMargin(on({{{0, 0}, 0}, {{2, 0}, 0}}), {1, 1, 0}), 0, 1e-9);
    EXPECT_NEAR(supportArea(on({{{0, 0}, 0}, {{2, 0}, 0}})), 0, 1e-12);
}

PlacedSphere ball(dvec3 place, double radius) { return {place, radius}; }

// On a narrow band the mass centre is as near to one side as to the other: to move from the nearest
// alone helps nothing.
TEST(SupportPolygon, finds_tangents_of_all_sides_that_are_nearly_as_near) {
    const SupportPolygon band = on({{{-0.1, 0}, 0.01}, {{0.1, 0}, 0.01}}).support;
    std::vector<SupportTangent> tangents;
    band.findTangents({0.02, 1, 0}, 0.005, tangents);
    ASSERT_EQ(tangents.size(), 2u);
    for (const SupportTangent& tangent : tangents) {
        EXPECT_NEAR(tangent.margin, 0.01, 1e-12);
        EXPECT_NEAR(std::abs(tangent.outward.y), 1, 1e-12);
        for (const auto& touch : tangent.touches) EXPECT_NEAR(touch.share, touch.contact == 0 ? 0.4 : 0.6, 1e-12);
    }
    EXPECT_NEAR(tangents[0].outward.y + tangents[1].outward.y, 0, 1e-12);
    band.findTangents({0, 1, 0.003}, 0.005, tangents);
    ASSERT_EQ(tangents.size(), 1u) << "the other is 6 mm farther";
    EXPECT_NEAR(tangents[0].outward.y, 1, 1e-12);
    EXPECT_EQ(tangents[0].margin, band.margin({0, 1, 0.003}));
    // In the middle of one disc every direction is alike.
    on({{{0.5, 0.5}, 0.02}}).support.findTangents({0.5, 1, 0.5}, 0.005, tangents);
    ASSERT_EQ(tangents.size(), 1u);
    EXPECT_NEAR(tangents[0].margin, 0.02, 1e-12);
}

// Example failure: of 48 fixed directions none is across the long side, and the nearest says 21 mm.
TEST(SupportPolygon, knows_how_near_a_long_side_is_that_is_turned) {
    const double turn = radians(3.75);
    const auto turned = [&](double x, double y) {
        return glm::dvec2(std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y);
    };
    std::vector<Contact> corners;
    for (const auto& [x, y] : {std::pair(-0.3, -0.1), {0.3, -0.1}, {0.3, 0.1}, {-0.3, 0.1}}) corners.push_back({turned(x, y)});
    const Contacts board = on(corners);
    for (const double inside : {0.002, 0.0, -0.002}) {
        const glm::dvec2 centre = turned(0.03, 0.1 - inside);
        EXPECT_NEAR(supportMargin(board, {centre.x, 1, centre.y}), inside, 1e-12);
    }
    EXPECT_NEAR(supportArea(board), 0.12, 1e-12);
}

// The same by looking at all pairs: the boundary's distance is the least of F(u) = max_i (place_i .
// u + radius_i) - centre . u over directions u, and F has its least where two discs reach as far,
// or across the way from a disc's middle.
struct Exhaustive {
    explicit Exhaustive(const std::vector<Contact>& discs) : discs(discs) {
        for (const Contact& a : discs)
            for (const Contact& b : discs) {
                const glm::dvec2 d = b.place - a.place;
                const double far = glm::length(d), less = a.radius - b.radius;
                if (far > std::abs(less)) kinks.push_back(std::atan2(d.y, d.x) - std::acos(less / far));
            }
    }
    static glm::dvec2 towards(double angle) { return {std::cos(angle), std::sin(angle)}; }
    double reach(const glm::dvec2& u) const {
        double far = -1e9;
        for (const Contact& disc : discs) far = std::max(far, glm::dot(disc.place, u) + disc.radius);
        return far;
    }
    double margin(const glm::dvec2& centre) const {
        double least = 1e9;
        const auto offer = [&](const glm::dvec2& u) { least = std::min(least, reach(u) - glm::dot(centre, u)); };
        for (const double kink : kinks) offer(towards(kink));
        for (const Contact& disc : discs) offer(centre == disc.place ? glm::dvec2(1, 0) : glm::normalize(centre - disc.place));
        return least;
    }
    // Half the integral of reach^2 - reach'^2, in pieces of one disc each (Santalo 1976, section
    // I.1.2).
    double area() const {
        std::vector<double> angles{0, 2 * std::numbers::pi};
        for (const double kink : kinks) angles.push_back(kink - 2 * std::numbers::pi * std::floor(kink / (2 * std::numbers::pi)));
        std::sort(angles.begin(), angles.end());
        double twice = 0;
        for (std::size_t i = 1; i < angles.size(); ++i) {
            const double from = angles[i - 1], to = angles[i];
            // Not in the middle, where one disc may touch another from within.
            const glm::dvec2 between = towards(std::lerp(from, to, 0.38));
            const Contact& disc = *std::max_element(discs.begin(), discs.end(), [&](const Contact& a, const Contact& b) {
                return glm::dot(a.place, between) + a.radius < glm::dot(b.place, between) + b.radius;
            });
            const double far = glm::length(disc.place), at = std::atan2(disc.place.y, disc.place.x), r = disc.radius;
            const auto whole = [&](double angle) {
                return 0.5 * far * far * std::sin(2 * (angle - at)) + 2 * r * far * std::sin(angle - at) + r * r * angle;
            };
            twice += whole(to) - whole(from);
        }
        return 0.5 * twice;
    }
    const std::vector<Contact>& discs;
    std::vector<double> kinks;
};

// 1 to 40 points, discs or both; some coincide, lie in each other or on a line.
std::vector<Contact> someStance(Rng& rng) {
    const auto count = 1 + rng.below(40), kind = rng.below(6);
    std::vector<Contact> discs;
    for (std::uint32_t i = 0; i < count; ++i) {
        Contact disc{{rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)}, rng.uniform(0, 0.1)};
        if (kind == 0 || (kind == 1 && rng.below(2) == 0)) disc.radius = 0;
        if (kind == 2) disc.radius = 0.05;
        if (kind == 3) disc.place.y = 0.3 * disc.place.x, disc.radius = rng.below(2) * disc.radius;
        if (kind == 4) disc.place = glm::round(4.0 * disc.place) / 8.0, disc.radius = rng.below(3) / 16.0;
        if (!discs.empty() && rng.below(10) == 0) disc.place = discs[rng.below(i)].place;
        if (!discs.empty() && rng.below(20) == 0) disc = discs[rng.below(i)];
        discs.push_back(disc);
    }
    return discs;
}

TEST(SupportPolygon, is_that_of_all_pairs_for_random_stances) {
    const char* const asked = std::getenv("FANTASCOPE_STANCES");  // 100000 for a thorough run
    const int stances = asked != nullptr ? std::atoi(asked) : 3000;
    Rng rng(1);
    for (int i = 0; i < stances; ++i) {
        const std::vector<Contact> discs = someStance(rng);
        const Contacts contacts = on(discs);
        const Exhaustive all(discs);
        ASSERT_NEAR(supportArea(contacts), all.area(), 1e-9) << "stance " << i;
        for (int k = 0; k < 2; ++k) {
            const dvec3 centre(rng.uniform(-0.7, 0.7), 1, rng.uniform(-0.7, 0.7));
            ASSERT_NEAR(supportMargin(contacts, centre), all.margin({centre.x, centre.z}), 1e-9) << "stance " << i;
        }
        const Contact& on = discs[rng.below(static_cast<std::uint32_t>(discs.size()))];
        ASSERT_NEAR(supportMargin(contacts, {on.place.x, 1, on.place.y}), all.margin(on.place), 1e-9) << "stance " << i;
    }
}

// How the margin changes with the place and the radius of each contact and with the mass centre. At
// a kink, such as with a third contact on an edge, there is no derivative: the differences to both
// sides are not alike.
TEST(SupportPolygon, tangents_hold_the_derivatives_of_the_margin) {
    Rng rng(2);
    constexpr double kStep = 1e-6;
    int compared = 0, kinks = 0;
    std::vector<SupportTangent> tangents;
    for (int i = 0; i < 500; ++i) {
        std::vector<Contact> discs = someStance(rng);
        dvec3 centre(rng.uniform(-0.6, 0.6), 1, rng.uniform(-0.6, 0.6));
        on(discs).support.findTangents(centre, 0, tangents);
        ASSERT_FALSE(tangents.empty());
        const SupportTangent tangent = tangents[0];
        EXPECT_NEAR(tangent.margin, supportMargin(on(discs), centre), 1e-12);
        EXPECT_NEAR(tangent.touches[0].share + tangent.touches[1].share, 1, 1e-12);
        EXPECT_NEAR(glm::length(tangent.outward), 1, 1e-12);
        const auto compare = [&](double& number, double derivative) {
            const double here = number, margin = supportMargin(on(discs), centre);
            number = here + kStep;
            const double after = (supportMargin(on(discs), centre) - margin) / kStep;
            number = here - kStep;
            const double before = (margin - supportMargin(on(discs), centre)) / kStep;
            number = here;
            if (std::abs(after - before) > 1e-3) return void(++kinks);
            EXPECT_NEAR(0.5 * (before + after), derivative, 1e-3) << "stance " << i;
            compared += derivative != 0;
        };
        compare(centre.x, -tangent.outward.x);
        compare(centre.z, -tangent.outward.y);
        for (std::uint32_t k = 0; k < discs.size(); ++k) {
            double share = 0;
            for (const auto& touch : tangent.touches) share += touch.contact == k ? touch.share : 0;
            compare(discs[k].place.x, share * tangent.outward.x);
            compare(discs[k].place.y, share * tangent.outward.y);
            if (discs[k].radius > 0) compare(discs[k].radius, share);
        }
    }
    EXPECT_GT(compared, 2000);
    EXPECT_LT(kinks, 0.25 * compared);
}

TEST(FindContacts, cuts_balls_at_the_touching_height) {
    Contacts contacts;
    // Resting, sunk by 1 cm, lifted by 5 mm, and far above.
    findContacts(std::vector{ball({1, 0.1, 2}, 0.1), ball({3, 0.09, 2}, 0.1), ball({5, 0.105, 2}, 0.1), ball({7, 0.5, 2}, 0.1)},
                 contacts);
    EXPECT_TRUE(contacts.touches);
    ASSERT_EQ(contacts.discs.size(), 3u);
    EXPECT_EQ(contacts.discs[0].place, glm::dvec2(1, 2));
    const auto chord = [](double above) { return std::sqrt(0.01 - above * above); };
    EXPECT_NEAR(contacts.discs[0].radius, chord(0.09), 1e-12);
    EXPECT_NEAR(contacts.discs[1].radius, chord(0.08), 1e-12);
    EXPECT_NEAR(contacts.discs[2].radius, chord(0.095), 1e-12);
}

TEST(FindContacts, nothing_sunk_is_wider_than_the_ball) {
    Contacts contacts;
    findContacts(std::vector{ball({0, -3, 0}, 0.1)}, contacts);
    EXPECT_NEAR(contacts.discs[0].radius, 0.1, 1e-12);
}

TEST(FindContacts, what_touches_nothing_stands_on_its_lowest_point) {
    Contacts contacts;
    findContacts(std::vector{ball({0, 0.1, 0}, 0.1)}, contacts);
    findContacts(std::vector{ball({4, 2, 5}, 0.3), ball({1, 1.9, 2}, 0.1)}, contacts);
    EXPECT_FALSE(contacts.touches);
    ASSERT_EQ(contacts.discs.size(), 1u);
    EXPECT_EQ(contacts.discs[0].place, glm::dvec2(4, 5));
    EXPECT_EQ(contacts.discs[0].radius, 0);
    EXPECT_NEAR(supportMargin(contacts, {4, 3, 5.3}), -0.3, 1e-9);
    EXPECT_NEAR(supportArea(contacts), 0, 1e-12);
}

// By hand: as of balls without size.
TEST(FindBearings, of_a_skin_fade_as_those_of_balls) {
    Contacts contacts, ofBalls;
    const std::vector<glm::vec3> vertices{{0, 0.2f, 0}, {1, 0.205f, 0}, {0, 0.215f, 2}, {4, 0.2251f, 4}, {0, 1, 9}};
    findBearings(vertices, {}, 0.02, contacts);
    EXPECT_FALSE(contacts.touches);
    EXPECT_NEAR(contacts.lowest, 0.2, 1e-6);
    ASSERT_EQ(contacts.discs.size(), 3u);
    std::vector<PlacedSphere> balls;
    for (const glm::vec3& vertex : vertices) balls.push_back(ball(vertex, 0));
    findBearings(balls, 0.02, ofBalls);
    EXPECT_NEAR(supportMargin(contacts, {0.2, 1, 0.2}), supportMargin(ofBalls, {0.2, 1, 0.2}), 1e-6);
    EXPECT_NEAR(supportArea(contacts), 0.5, 1e-4);  // the corner at z = 2 is half way to the lowest point
}

// By hand: a ball of 10 cm on the floor, one 5 mm above it, one a half and one wholly faded.
TEST(FindBearings, what_is_higher_bears_less) {
    Contacts contacts;
    const double bearing = 0.02;
    const std::vector balls{ball({0, 0.1, 0}, 0.1), ball({1, 0.105, 0}, 0.1), ball({0, 0.115, 2}, 0.1),
                            ball({4, 0.1251, 4}, 0.1)};
    findBearings(balls, bearing, contacts);
    ASSERT_EQ(contacts.discs.size(), 3u);
    const double whole = std::sqrt(0.01 - 0.09 * 0.09);
    EXPECT_EQ(contacts.discs[0].place, glm::dvec2(0));
    EXPECT_NEAR(contacts.discs[1].radius, whole, 1e-12);
    EXPECT_NEAR(contacts.discs[1].place.x, 1, 1e-12);
    EXPECT_NEAR(contacts.discs[2].radius, 0.5 * whole, 1e-9);
    EXPECT_NEAR(contacts.discs[2].place.y, 1, 1e-9);
    EXPECT_TRUE(contacts.touches);
}

TEST(FindBearings, is_as_if_on_the_floor_and_without_jumps) {
    const glm::dvec3 centre(0.4, 1, 0.2);
    double last = 0;
    for (int i = 0; i <= 300; ++i) {
        Contacts low, high;
        const double up = 1e-4 * i;
        findBearings(std::vector{ball({0, 0.1, 0}, 0.1), ball({1, 0.1 + up, 0}, 0.1)}, 0.02, low);
        findBearings(std::vector{ball({0, 0.4, 0}, 0.1), ball({1, 0.4 + up, 0}, 0.1)}, 0.02, high);
        const double margin = supportMargin(low, centre);
        EXPECT_NEAR(margin, supportMargin(high, centre), 1e-9);
        if (i > 0) {
            EXPECT_NEAR(margin, last, 0.01) << i;
        }
        last = margin;
    }
    // On both feet it is the band between them that holds, on one the disc.
    EXPECT_LT(last, -0.3);
}

TEST(FindContacts, knows_how_low_the_lowest_point_is) {
    Contacts contacts;
    findContacts(std::vector{ball({1, 0.1, 2}, 0.1), ball({3, 0.07, 2}, 0.1)}, contacts);
    EXPECT_NEAR(contacts.lowest, -0.03, 1e-12);
    findContacts(std::vector<glm::vec3>{{1, 2, 3}, {4, 0.5f, 6}, {1, 1, 1}}, {}, contacts);
    EXPECT_EQ(contacts.lowest, 0.5);
    EXPECT_FALSE(contacts.touches);
    ASSERT_EQ(contacts.discs.size(), 1u);
    EXPECT_EQ(contacts.discs[0].place, glm::dvec2(4, 6));
}

// Few points stand for all: margins and areas are those of all vertices that touch.
TEST(FindContacts, of_a_skin_are_the_corners_of_what_touches) {
    Rng rng(1);
    for (const int count : {1, 2, 5, 300}) {
        std::vector<glm::vec3> vertices;
        Contacts all;
        for (int i = 0; i < count; ++i) {
            const glm::vec3 touching(rng.uniform(-1, 1), rng.uniform(-0.01, 0.0099), rng.uniform(-2, 2));
            vertices.push_back(touching);
            vertices.emplace_back(rng.uniform(-9, 9), rng.uniform(0.0101, 1), rng.uniform(-9, 9));
            all.discs.push_back({{touching.x, touching.z}, 0});
        }
        all.support.build(all.discs);
        Contacts contacts;
        findContacts(vertices, {}, contacts);
        EXPECT_TRUE(contacts.touches);
        EXPECT_LE(contacts.discs.size(), 48u);
        EXPECT_LE(contacts.discs.size(), static_cast<std::size_t>(count));
        for (int i = 0; i < 20; ++i) {
            const dvec3 centre(rng.uniform(-2, 2), 1, rng.uniform(-3, 3));
            EXPECT_DOUBLE_EQ(supportMargin(contacts, centre), supportMargin(all, centre));
        }
        EXPECT_DOUBLE_EQ(supportArea(contacts), supportArea(all));
    }
}

// An edge from the floor up to 4 cm touches with its lowest quarter.
TEST(FindContacts, cuts_the_edges_of_a_skin) {
    Contacts contacts;
    const std::vector<glm::vec3> vertices{{0, 0, 0}, {0, 0, 1}, {4, 0.04f, 0}};
    const std::vector<MeshEdge> edges{{0, 2, 0, 1}};
    findContacts(vertices, edges, contacts);
    EXPECT_NEAR(supportArea(contacts), 0.5, 1e-5);
    EXPECT_NEAR(supportMargin(contacts, {1.5, 1, 0}), -0.5, 2e-3);
}

TEST(FindContacts, a_person_stands_on_its_soles) {
    const Body body = humanBody(1.75);
    const BodyMesh mesh = humanMesh(body);
    PosedBody posed;
    std::vector<glm::vec3> skin;
    Contacts contacts;
    const auto stand = [&](double height) {
        posed.pose(body, body.restPose(body.joints[0].offset + dvec3(0, height, 0), {1, 0, 0, 0}));
        mesh.skin(body, posed, skin);
        findContacts(skin, mesh.edges, contacts);
    };
    stand(0);
    EXPECT_TRUE(contacts.touches);
    EXPECT_NEAR(contacts.lowest, 0, 0.002);
    EXPECT_GT(supportMargin(contacts, posed.massCentre()), 0.02);
    // Two feet as long as feet are, with what lies between.
    EXPECT_GT(supportArea(contacts), 0.04);
    EXPECT_LT(supportArea(contacts), 0.10);
    stand(0.2);
    EXPECT_FALSE(contacts.touches);
    EXPECT_NEAR(contacts.lowest, 0.2, 0.002);
}

}  // namespace
}  // namespace fantascope::theatre
