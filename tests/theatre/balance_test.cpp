#include "theatre/balance.h"

#include "theatre/body_mesh.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

Contacts on(std::vector<Contact> discs) { return {std::move(discs), true}; }
// The hull is felt in 48 directions.
constexpr double kShare = 0.003;

TEST(SupportMargin, OfASquareIsTheDistanceToItsNearestSide) {
    const Contacts square = on({{{0, 0}, 0}, {{1, 0}, 0}, {{1, 1}, 0}, {{0, 1}, 0}, {{0.5, 0.4}, 0}});
    EXPECT_NEAR(supportMargin(square, {0.5, 9, 0.5}), 0.5, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.3, 1, 0.6}), 0.3, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.3, 1, 0.9}), 0.1, 1e-9);
    EXPECT_NEAR(supportMargin(square, {1, 1, 0.5}), 0, 1e-9);
    EXPECT_NEAR(supportMargin(square, {1.2, 1, 0.5}), -0.2, 1e-9);
    EXPECT_NEAR(supportMargin(square, {0.5, 1, -0.4}), -0.4, 1e-9);
    // Beyond a corner it is the distance to the corner.
    EXPECT_NEAR(supportMargin(square, {1.3, 1, 1.4}), -0.5, kShare * 0.5);
    EXPECT_NEAR(supportArea(square), 1, 1e-9);
}

TEST(SupportMargin, OfFeetReachesAroundTheirDiscs) {
    const Contacts square = on({{{0, 0}, 0.1}, {{1, 0}, 0.1}, {{1, 1}, 0.1}, {{0, 1}, 0.1}});
    EXPECT_NEAR(supportMargin(square, {0.5, 1, 0.9}), 0.2, 1e-9);
    EXPECT_NEAR(supportArea(square), 1 + 0.4 + std::numbers::pi * 0.01, kShare);
}

TEST(SupportMargin, OfOneContactIsOfItsDisc) {
    const Contacts disc = on({{{2, 3}, 0.2}});
    EXPECT_NEAR(supportMargin(disc, {2, 1, 3}), 0.2, 1e-9);
    EXPECT_NEAR(supportMargin(disc, {2.09, 1, 3.12}), 0.05, 1e-3);
    EXPECT_NEAR(supportMargin(disc, {2.3, 1, 3.4}), -0.3, 1e-3);
    EXPECT_NEAR(supportArea(disc), std::numbers::pi * 0.04, kShare * 0.13);
}

TEST(SupportMargin, OfTwoContactsIsOfTheBandAround) {
    const Contacts band = on({{{0, 0}, 0.05}, {{2, 0}, 0.05}});
    EXPECT_NEAR(supportMargin(band, {1, 1, 0}), 0.05, 1e-9);
    EXPECT_NEAR(supportMargin(band, {1, 1, 0.03}), 0.02, 1e-9);
    EXPECT_NEAR(supportMargin(band, {0.4, 1, -0.5}), -0.45, 1e-3);
    EXPECT_NEAR(supportMargin(band, {2.35, 1, 0}), -0.3, 1e-9);
    EXPECT_NEAR(supportArea(band), 2 * 0.1 + std::numbers::pi * 0.0025, 1e-3);
    // Points alone: nothing to stand on.
    EXPECT_NEAR(supportMargin(on({{{0, 0}, 0}, {{2, 0}, 0}}), {1, 1, 0}), 0, 1e-9);
    EXPECT_NEAR(supportArea(on({{{0, 0}, 0}, {{2, 0}, 0}})), 0, 1e-12);
}

PlacedSphere ball(dvec3 place, double radius) { return {place, radius}; }

// On a narrow band the mass centre is as near to one side as to the other: to move from the nearest alone helps nothing.
TEST(FindSupportTangents, AreOfAllSidesThatAreNearlyAsNear) {
    Contacts band;
    band.discs = {{{-0.1, 0}, 0.01}, {{0.1, 0}, 0.01}};
    std::vector<SupportTangent> tangents;
    findSupportTangents(band, {0.02, 1, 0}, 0.005, tangents);
    ASSERT_EQ(tangents.size(), 2u);
    for (const SupportTangent& tangent : tangents) {
        EXPECT_NEAR(tangent.margin, 0.01, 1e-12);
        EXPECT_NEAR(std::abs(tangent.outward.y), 1, 1e-12);
    }
    EXPECT_NEAR(tangents[0].outward.y + tangents[1].outward.y, 0, 1e-12);
    findSupportTangents(band, {0, 1, 0.003}, 0.005, tangents);
    ASSERT_EQ(tangents.size(), 1u) << "the other is 6 mm farther";
    EXPECT_NEAR(tangents[0].outward.y, 1, 1e-12);
    EXPECT_EQ(tangents[0].margin, supportMargin(band, {0, 1, 0.003}));
    // In the middle of one disc every direction is alike.
    Contacts disc;
    disc.discs = {{{0.5, 0.5}, 0.02}};
    findSupportTangents(disc, {0.5, 1, 0.5}, 0.005, tangents);
    EXPECT_GE(tangents.size(), 1u);
    EXPECT_NEAR(tangents[0].margin, 0.02, 1e-12);
}

TEST(FindContacts, CutsBallsAtTheTouchingHeight) {
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

TEST(FindContacts, NothingSunkIsWiderThanTheBall) {
    Contacts contacts;
    findContacts(std::vector{ball({0, -3, 0}, 0.1)}, contacts);
    EXPECT_NEAR(contacts.discs[0].radius, 0.1, 1e-12);
}

TEST(FindContacts, WhatTouchesNothingStandsOnItsLowestPoint) {
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
TEST(FindBearings, OfASkinFadeAsThoseOfBalls) {
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
TEST(FindBearings, WhatIsHigherBearsLess) {
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

TEST(FindBearings, IsAsIfOnTheFloorAndWithoutJumps) {
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

TEST(FindContacts, KnowsHowLowTheLowestPointIs) {
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
TEST(FindContacts, OfASkinAreTheCornersOfWhatTouches) {
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
TEST(FindContacts, CutsTheEdgesOfASkin) {
    Contacts contacts;
    const std::vector<glm::vec3> vertices{{0, 0, 0}, {0, 0, 1}, {4, 0.04f, 0}};
    const std::vector<MeshEdge> edges{{0, 2, 0, 1}};
    findContacts(vertices, edges, contacts);
    EXPECT_NEAR(supportArea(contacts), 0.5, 1e-5);
    EXPECT_NEAR(supportMargin(contacts, {1.5, 1, 0}), -0.5, 2e-3);
}

TEST(FindContacts, APersonStandsOnItsSoles) {
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
