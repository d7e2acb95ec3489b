// The sun by other people's tables, the clocks of other people's zones, and nights that are planned
// with both.

#include "show/schedule/nights.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <numbers>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }
Time utc(Date date, Time timeOfDay) { return std::chrono::sys_days(date).time_since_epoch() + timeOfDay; }

// From PyEphem 4.1.4 (VSOP87, the sun's middle 50' and 6 degrees below a level horizon, no air), in
// seconds since 1970; 0: not in that night.
constexpr struct {
    const char* place;
    double latitude, longitude;  // degrees
    const char* date;
    std::int64_t sunset, civilDusk, sunrise;
} kAlmanac[] = {
    {"Quito", -0.18, -78.47, "2026-01-09", 1768001103, 1768002441, 1768043850},
    {"Quito", -0.18, -78.47, "2026-02-14", 1771111893, 1771113164, 1771154663},
    {"Quito", -0.18, -78.47, "2026-03-20", 1774049070, 1774050310, 1774091863},
    {"Quito", -0.18, -78.47, "2026-04-27", 1777331681, 1777332959, 1777374487},
    {"Quito", -0.18, -78.47, "2026-05-31", 1780269296, 1780270634, 1780312105},
    {"Quito", -0.18, -78.47, "2026-06-21", 1782083947, 1782085299, 1782126756},
    {"Quito", -0.18, -78.47, "2027-07-17", 1815866603, 1815867932, 1815909411},
    {"Quito", -0.18, -78.47, "2027-08-30", 1819667861, 1819669116, 1819710662},
    {"Quito", -0.18, -78.47, "2027-09-23", 1821740969, 1821742208, 1821783759},
    {"Quito", -0.18, -78.47, "2028-10-12", 1855004614, 1855005866, 1855047392},
    {"Quito", -0.18, -78.47, "2028-11-27", 1858979141, 1858980473, 1859021889},
    {"Quito", -0.18, -78.47, "2028-12-21", 1861053383, 1861054736, 1861096126},
    {"Vienna", 48.21, 16.37, "2026-01-09", 1767971997, 1767974146, 1768027388},
    {"Vienna", 48.21, 16.37, "2026-02-14", 1771085683, 1771087617, 1771135294},
    {"Vienna", 48.21, 16.37, "2026-03-20", 1774026423, 1774028291, 1774068943},
    {"Vienna", 48.21, 16.37, "2026-04-27", 1777312939, 1777315005, 1777347672},
    {"Vienna", 48.21, 16.37, "2026-05-31", 1780253148, 1780255551, 1780282709},
    {"Vienna", 48.21, 16.37, "2026-06-21", 1782068323, 1782070822, 1782096850},
    {"Vienna", 48.21, 16.37, "2027-07-17", 1815850151, 1815852500, 1815880358},
    {"Vienna", 48.21, 16.37, "2027-08-30", 1819647636, 1819649585, 1819685418},
    {"Vienna", 48.21, 16.37, "2027-09-23", 1821718265, 1821720128, 1821761002},
    {"Vienna", 48.21, 16.37, "2028-10-12", 1854979848, 1854981725, 1855026698},
    {"Vienna", 48.21, 16.37, "2028-11-27", 1858950293, 1858952414, 1859005240},
    {"Vienna", 48.21, 16.37, "2028-12-21", 1861023783, 1861025983, 1861080186},
    {"Tromso", 69.65, 18.96, "2026-01-09", 0, 1767965438, 0},
    {"Tromso", 69.65, 18.96, "2026-02-14", 1771079892, 1771083996, 1771139704},
    {"Tromso", 69.65, 18.96, "2026-03-20", 1774026090, 1774029724, 1774067962},
    {"Tromso", 69.65, 18.96, "2026-04-27", 1777319094, 1777327322, 1777340236},
    {"Tromso", 69.65, 18.96, "2026-05-31", 0, 0, 0},
    {"Tromso", 69.65, 18.96, "2026-06-21", 0, 0, 0},
    {"Tromso", 69.65, 18.96, "2027-07-17", 0, 0, 0},
    {"Tromso", 69.65, 18.96, "2027-08-30", 1819650910, 1819655423, 1819680950},
    {"Tromso", 69.65, 18.96, "2027-09-23", 1821717853, 1821721459, 1821760244},
    {"Tromso", 69.65, 18.96, "2028-10-12", 1854976478, 1854980140, 1855028928},
    {"Tromso", 69.65, 18.96, "2028-11-27", 0, 1858944316, 0},
    {"Tromso", 69.65, 18.96, "2028-12-21", 0, 1861016006, 0},
    {"Sydney", -33.87, 151.21, "2026-01-09", 1767949794, 1767951512, 1767984893},
    {"Sydney", -33.87, 151.21, "2026-02-14", 1771058940, 1771060511, 1771097399},
    {"Sydney", -33.87, 151.21, "2026-03-20", 1773994016, 1773995510, 1774036724},
    {"Sydney", -33.87, 151.21, "2026-04-27", 1777274330, 1777275871, 1777321632},
    {"Sydney", -33.87, 151.21, "2026-05-31", 1780210475, 1780212113, 1780260684},
    {"Sydney", -33.87, 151.21, "2026-06-21", 1782024829, 1782026492, 1782075611},
    {"Sydney", -33.87, 151.21, "2027-07-17", 1815807921, 1815809549, 1815857822},
    {"Sydney", -33.87, 151.21, "2027-08-30", 1819611328, 1819612839, 1819656941},
    {"Sydney", -33.87, 151.21, "2027-09-23", 1821685904, 1821687400, 1821728573},
    {"Sydney", -33.87, 151.21, "2028-10-12", 1854950776, 1854952301, 1854990974},
    {"Sydney", -33.87, 151.21, "2028-11-27", 1858927672, 1858929374, 1858963071},
    {"Sydney", -33.87, 151.21, "2028-12-21", 1861002340, 1861004090, 1861036884},
    {"Ushuaia", -54.80, -68.30, "2026-01-09", 1768007268, 1768010463, 1768032824},
    {"Ushuaia", -54.80, -68.30, "2026-02-14", 1771114103, 1771116537, 1771147622},
    {"Ushuaia", -54.80, -68.30, "2026-03-20", 1774046731, 1774048887, 1774089387},
    {"Ushuaia", -54.80, -68.30, "2026-04-27", 1777324438, 1777326722, 1777376921},
    {"Ushuaia", -54.80, -68.30, "2026-05-31", 1780258718, 1780261334, 1780317844},
    {"Ushuaia", -54.80, -68.30, "2026-06-21", 1782072677, 1782075392, 1782133141},
    {"Ushuaia", -54.80, -68.30, "2027-07-17", 1815856435, 1815859002, 1815914644},
    {"Ushuaia", -54.80, -68.30, "2027-08-30", 1819662532, 1819664724, 1819711039},
    {"Ushuaia", -54.80, -68.30, "2027-09-23", 1821738766, 1821740931, 1821781017},
    {"Ushuaia", -54.80, -68.30, "2028-10-12", 1855005037, 1855007315, 1855042032},
    {"Ushuaia", -54.80, -68.30, "2028-11-27", 1858985002, 1858988116, 1859011120},
    {"Ushuaia", -54.80, -68.30, "2028-12-21", 1861060292, 1861063740, 1861084335},
    {"Honolulu", 21.31, -157.86, "2026-01-09", 1768017990, 1768019429, 1768065072},
    {"Honolulu", 21.31, -157.86, "2026-02-14", 1771129743, 1771131106, 1771174901},
    {"Honolulu", 21.31, -157.86, "2026-03-20", 1774068156, 1774069488, 1774110858},
    {"Honolulu", 21.31, -157.86, "2026-04-27", 1777352114, 1777353504, 1777392142},
    {"Honolulu", 21.31, -157.86, "2026-05-31", 1780290571, 1780292043, 1780328935},
    {"Honolulu", 21.31, -157.86, "2026-06-21", 1782105378, 1782106870, 1782143438},
    {"Honolulu", 21.31, -157.86, "2027-07-17", 1815887766, 1815889225, 1815926366},
    {"Honolulu", 21.31, -157.86, "2027-08-30", 1819687756, 1819689110, 1819728883},
    {"Honolulu", 21.31, -157.86, "2027-09-23", 1821759998, 1821761328, 1821802846},
    {"Honolulu", 21.31, -157.86, "2028-10-12", 1855022924, 1855024265, 1855067202},
    {"Honolulu", 21.31, -157.86, "2028-11-27", 1858996091, 1858997524, 1859043065},
    {"Honolulu", 21.31, -157.86, "2028-12-21", 1861070107, 1861071563, 1861117522},
};

TEST(Sun, agrees_with_the_almanac_within_a_minute_at_six_places_on_twelve_days) {
    double farthest = 0;
    for (const auto& row : kAlmanac) {
        SCOPED_TRACE(fmt::format("{} {}", row.place, row.date));
        const Time noon = utc(dateOf(row.date).value(), 12h) - std::chrono::duration_cast<Time>(row.longitude / 15 * 1h);
        const auto compare = [&](SunEvent event, std::int64_t wanted) {
            const auto found = timeOf(event, noon, radians(row.latitude), radians(row.longitude));
            ASSERT_EQ(found.has_value(), wanted != 0);
            if (!found) return;
            const double off = std::abs(seconds(*found - std::chrono::seconds(wanted)));
            farthest = std::max(farthest, off);
            EXPECT_LT(off, 60);
        };
        compare(SunEvent::Sunset, row.sunset);
        compare(SunEvent::CivilDusk, row.civilDusk);
        compare(SunEvent::Sunrise, row.sunrise);
    }
    fmt::print("at most {:.1f} s\n", farthest);
}

TEST(Sun, goes_down_in_the_order_of_the_twilights) {
    std::optional<Time> before;
    for (int event = 0; event < 8; ++event) {
        const auto at = timeOf(static_cast<SunEvent>(event), utc(2026y / 11 / 27, 11h), radians(48.2), radians(16.4));
        ASSERT_TRUE(at);
        EXPECT_LT(before.value_or(Time::min()), *at);
        before = at;
    }
}

TimeZone zone(const char* name) { return TimeZone::named(name).value(); }

TEST(TimeZone, knows_summer_time_both_ways) {
    const TimeZone vienna = zone("Europe/Vienna");
    EXPECT_EQ(vienna.at(utc(2026y / 3 / 29, 59min)).offset, 1h);
    EXPECT_EQ(vienna.at(utc(2026y / 3 / 29, 1h)).offset, 2h);
    EXPECT_EQ(vienna.at(utc(2026y / 10 / 25, 59min)).timeOfDay, 2h + 59min);
    EXPECT_EQ(vienna.at(utc(2026y / 10 / 25, 1h)).timeOfDay, 2h) << "the hour comes again";
    EXPECT_EQ(zone("Australia/Sydney").at(utc(2026y / 12 / 24, 12h)).offset, 11h);
}

// Example failure: a show that ends at 2:30 never ends in the night in which there is no 2:30.
TEST(TimeZone, has_a_moment_for_every_time_of_day) {
    const TimeZone vienna = zone("Europe/Vienna");
    EXPECT_EQ(vienna.utcOf(2026y / 7 / 1, 22h), utc(2026y / 7 / 1, 20h));
    EXPECT_EQ(vienna.utcOf(2026y / 3 / 29, 2h + 30min), utc(2026y / 3 / 29, 1h)) << "clocks go from 2 to 3";
    EXPECT_EQ(vienna.utcOf(2026y / 10 / 25, 2h + 30min), utc(2026y / 10 / 25, 30min)) << "the first of two";
    EXPECT_EQ(vienna.utcOf(2026y / 10 / 25, 3h), utc(2026y / 10 / 25, 2h));
}

TEST(TimeZone, that_is_unknown_suggests_one) {
    EXPECT_THAT(TimeZone::named("Europe/Vienne").error().message(), HasSubstr("did you mean 'Europe/Vienna'?"));
    EXPECT_THAT(TimeZone::named("here").error().message(), HasSubstr("like 'Europe/Vienna'"));
}

Result<NightTime> timeIn(const std::string& text) {
    return readNightTime(ConfigNode::parse("at: \"" + text + "\"", "a.yaml").value().entries().value()[0].second);
}

TEST(NightTime, is_read_and_written) {
    for (const char* const text : {"22:30", "00:05", "sunset", "civil dusk + 0:15", "sunrise - 1:30", "astronomical dawn"})
        EXPECT_EQ(textOf(timeIn(text).value()), text);
    EXPECT_EQ(timeIn("sunset+0:05").value(), timeIn("sunset + 0:05").value());
    EXPECT_EQ(textOf(timeIn("9:00").value()), "09:00");
    for (const char* const text :
         {"24:00", "22:60", "22", "22:3", "noon", "sunset + 5", "sunset +", "+ 0:15", "-1:00", "sunset 22:30", "1e9:00"})
        EXPECT_THAT(timeIn(text).error().message(), HasSubstr("a.yaml:1:5: at: '")) << text;
}

constexpr const char* kPlace = "place: {latitude: 48.2, longitude: 16.37, time_zone: Europe/Vienna}";

Nights nightsOf(const std::string& schedule, const std::string& place = kPlace) {
    const ConfigNode items = ConfigNode::parse(schedule, "show.yaml").value();
    const ConfigNode where = ConfigNode::parse(place, "site.yaml").value().entries().value()[0].second;
    return {readSchedule(items, {"Night", "Storm", "Bells"}).value(), readPlace(where).value()};
}

// "16:17 Night", by the place's clocks.
std::vector<std::string> playedIn(const Nights& nights, Date date) {
    constexpr const char* kCues[] = {"dark", "Night", "Storm", "Bells"};
    std::vector<std::string> lines;
    for (const Nights::Moment& moment : nights.night(date).moments)
        lines.push_back(clockOf(nights.zone().at(moment.utc).timeOfDay) + " " + kCues[moment.cue + 1]);
    return lines;
}

TEST(Nights, play_what_is_written) {
    const Nights nights = nightsOf(R"(
nights:
  - {cue: Night, from: sunset + 0:15, until: "23:00"}
  - {cue: Night, from: sunset + 0:15, until: "0:30", on: [fri, sat]}
  - {cue: Bells, from: "22:00", on: [sat]}
dark: [2026-12-24]
first: 2026-11-27
last: 2027-01-06
)");
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 1), ElementsAre("16:17 Night", "23:00 dark"));
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 4), ElementsAre("16:16 Night", "00:30 dark")) << "the later line counts";
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 5), ElementsAre("16:16 Night", "22:00 Bells", "12:00 dark"))
        << "until the night ends";
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 24), IsEmpty());
    EXPECT_THAT(nights.night(2026y / 12 / 24).remarks, ElementsAre("dark"));
    EXPECT_THAT(playedIn(nights, 2026y / 11 / 26), IsEmpty());
    EXPECT_THAT(playedIn(nights, 2027y / 1 / 6), ElementsAre("16:31 Night", "23:00 dark"));
    EXPECT_THAT(nights.night(2027y / 1 / 7).remarks, ElementsAre("out of season"));
}

// A night has the date of its evening, also when the day has changed.
TEST(Nights, last_from_noon_to_noon) {
    const Nights nights = nightsOf("nights: [{cue: Night, from: \"22:00\", until: \"1:00\", on: [fri]}]");
    const Time begin = utc(2026y / 11 / 27, 21h), end = utc(2026y / 11 / 28, 0h);  // a Friday
    EXPECT_EQ(nights.at(begin - 1ns).cue, Nights::kDark);
    EXPECT_EQ(nights.at(begin), (Nights::Moment{begin, 0}));
    EXPECT_EQ(nights.at(end - 1ns), (Nights::Moment{begin, 0})) << "by now it is Saturday";
    EXPECT_EQ(nights.at(end), (Nights::Moment{end, Nights::kDark}));
    EXPECT_EQ(nights.after(begin), (Nights::Moment{end, Nights::kDark}));
    EXPECT_EQ(nights.after(end), (Nights::Moment{begin + 7 * 24h, 0}));
    EXPECT_EQ(nights.nextFrom(2026y / 11 / 28)->date, 2026y / 12 / 4);
    EXPECT_THAT(nights.between(begin - 1h, begin + 24h), testing::SizeIs(2));
}

TEST(Nights, have_an_hour_less_and_more_when_the_clocks_change) {
    const Nights nights =
        nightsOf("nights: [{cue: Night, from: \"22:00\", until: \"2:30\"}, {cue: Storm, from: \"2:45\", until: \"3:30\"}]");
    const auto lengths = [&](Date date) {
        std::vector<Time> lengths;
        const auto moments = nights.night(date).moments;
        for (std::size_t i = 0; i + 1 < moments.size(); ++i) lengths.push_back(moments[i + 1].utc - moments[i].utc);
        return lengths;
    };
    EXPECT_THAT(lengths(2026y / 6 / 1), ElementsAre(4h + 30min, 15min, 45min));
    EXPECT_THAT(lengths(2026y / 3 / 28), ElementsAre(4h, 30min)) << "2:30 and 2:45 are both when 2 becomes 3";
    EXPECT_THAT(lengths(2026y / 10 / 24), ElementsAre(4h + 30min, 15min, 1h + 45min)) << "2:00 to 3:00 comes twice";
}

TEST(Nights, keep_the_hours_that_the_town_allows) {
    const char* const place =
        "place: {latitude: 48.2, longitude: 16.37, time_zone: Europe/Vienna, hours: ["
        "{from: \"17:00\", until: \"0:00\", on: [fri, sat]}, {from: \"17:00\", until: \"22:00\", on: [mon, tue, wed, thu]}]}";
    const Nights nights = nightsOf("nights: [{cue: Night, from: sunset}, {cue: Storm, from: \"22:30\", until: \"0:30\"}]", place);
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 4), ElementsAre("17:00 Night", "22:30 Storm", "00:00 dark"));
    EXPECT_THAT(nights.night(2026y / 12 / 4).remarks, ElementsAre("cut to the allowed hours"));
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 3), ElementsAre("17:00 Night", "22:00 dark"));
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 6), IsEmpty()) << "nothing is allowed on Sundays";
    EXPECT_THAT(nights.night(2026y / 12 / 6).remarks, ElementsAre("light is not allowed"));
    EXPECT_THAT(playedIn(nights, 2026y / 6 / 5), ElementsAre("20:50 Night", "22:30 Storm", "00:00 dark"));
    EXPECT_EQ(playedIn(nights, 2026y / 6 / 4), (std::vector<std::string>{"20:49 Night", "22:00 dark"}));
}

TEST(Nights, without_a_sunset_say_so) {
    const Nights nights =
        nightsOf("nights: [{cue: Night, from: sunset, until: sunrise}, {cue: Storm, from: \"23:00\", until: \"23:30\"}]",
                 "place: {latitude: 69.65, longitude: 18.96, time_zone: Europe/Oslo}");
    EXPECT_THAT(playedIn(nights, 2026y / 6 / 21), ElementsAre("23:00 Storm", "23:30 dark"));
    EXPECT_THAT(nights.night(2026y / 6 / 21).remarks, ElementsAre("no sunset", "no sunrise"));
    EXPECT_THAT(nights.night(2026y / 9 / 21).moments, testing::SizeIs(3)) << "the storm ends the night's cue";
}

TEST(Nights, never_play_a_cue_that_would_end_before_it_begins) {
    const Nights nights = nightsOf("nights: [{cue: Night, from: sunset, until: \"20:00\"}]");
    EXPECT_THAT(playedIn(nights, 2026y / 12 / 1), ElementsAre("16:02 Night", "20:00 dark"));
    EXPECT_THAT(playedIn(nights, 2026y / 6 / 21), IsEmpty());
    EXPECT_THAT(nights.night(2026y / 6 / 21).remarks, ElementsAre("a cue would end before it begins"));
}

TEST(Schedule, tells_all_that_is_wrong_with_its_place) {
    const ConfigNode node = ConfigNode::parse(R"(nights:
  - {cue: Nigth, from: sunset}
  - {cue: Night, from: "25:00", on: [fry]}
dark: [2026-02-30]
first: tomorrow
)",
                                              "show.yaml")
                                .value();
    const std::string message = readSchedule(node, {"Night"}).error().message();
    for (const char* const wanted : {"show.yaml:2:11", "here is 'Nigth'", "show.yaml:3:24", "show.yaml:3:38", "'fry'",
                                     "show.yaml:4:8", "there is no date '2026-02-30'", "show.yaml:5:8", "like '2026-12-24'"})
        EXPECT_THAT(message, HasSubstr(wanted));
    const ConfigNode never =
        ConfigNode::parse("{first: 2026-12-02, last: 2026-12-01, nights: [{cue: Night, from: sunset}]}", "s").value();
    EXPECT_THAT(readSchedule(never, {"Night"}).error().message(), HasSubstr("'last' is before 'first'"));
    const ConfigNode place = ConfigNode::parse("{latitude: 95, longitude: 16, time_zone: Europe/Viena}", "site.yaml").value();
    EXPECT_THAT(readPlace(place).error().message(),
                testing::AllOf(HasSubstr("latitude"), HasSubstr("did you mean 'Europe/Vienna'?")));
}

}  // namespace
}  // namespace fantascope::show
