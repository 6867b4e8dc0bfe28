#include <osgTerrainLight/SunPosition.h>

#include <gtest/gtest.h>

#include <string>
#include <utility>

using namespace osgTerrainLight;

namespace
{
UtcTime at(const std::string& text)
{
    UtcTime time;
    EXPECT_EQ(readUtcTime(text, time), "") << text;
    return time;
}
} // namespace

TEST(UtcTime, ReadsIso8601)
{
    const auto milliseconds = [](const std::string& text)
    { return at(text).time_since_epoch().count(); };
    EXPECT_EQ(milliseconds("1970-01-01T00:00"), 0);
    EXPECT_EQ(milliseconds("1970-01-01T00:00:01Z"), 1000);
    EXPECT_EQ(milliseconds("1970-01-01T00:00:00.25"), 250);
    EXPECT_EQ(milliseconds("1970-01-01T00:00:00.1239Z"), 123);
    EXPECT_EQ(milliseconds("1969-12-31T23:59:59"), -1000);
    EXPECT_EQ(milliseconds("1970-01-01T01:30+01:30"), 0);
    EXPECT_EQ(milliseconds("1969-12-31T17:00:00-07:00"), 0);
    EXPECT_EQ(milliseconds("2000-03-01T00:00"), 951868800000); // a leap year
    EXPECT_EQ(milliseconds("1900-01-01T00:00"), -2208988800000);
}

TEST(UtcTime, WritesWhatItReads)
{
    for (const char* text :
         {"1970-01-01T00:00:00Z", "1969-12-31T23:59:59.999Z", "2024-02-29T12:34:56Z",
          "1900-01-01T00:00:00Z", "2100-12-31T23:59:59Z"})
        EXPECT_EQ(toString(at(text)), text);
    EXPECT_EQ(toString(at("2024-06-21T10:30+02:00")), "2024-06-21T08:30:00Z");
}

TEST(UtcTime, RefusesWhatIsNoTimeAndKeepsTheOldOne)
{
    UtcTime time = at("2024-01-01T00:00");
    for (const char* text : {"",
                             "today",
                             "2024-06-21",
                             "2024-06-21T10",
                             "2024-06-21T103",
                             "2024-0621T10:30",
                             "202406-21T10:30",
                             "2024-06-21T10:60",
                             "2024-06-21T10:30:60",
                             "2024-06-21T10:30:",
                             "2024-06-21T10:30:00.",
                             "2023-02-29T00:00",
                             "2024-13-01T00:00",
                             "2024-00-01T00:00",
                             "2024-06-31T00:00",
                             "1899-12-31T23:59",
                             "2101-01-01T00:00",
                             "-024-06-21T10:30",
                             "2024--6-21T10:30",
                             "2024-06-21T10:30+2",
                             "2024-06-21T10:30ZZ",
                             "2024-06-21T10:30+24:00",
                             "2024-06-21T-1:30"})
    {
        const std::string said = readUtcTime(text, time);
        EXPECT_NE(said.find("\"" + std::string(text) + "\": needs a time YYYY-MM-DDThh:mm"),
                  std::string::npos)
            << text << ": " << said;
        EXPECT_EQ(time, at("2024-01-01T00:00"));
    }
}

// Every right value is the first form of the same moment, which ReadsIso8601 counts from the epoch.
TEST(UtcTime, ReadsTimesAsPeopleWriteThem)
{
    const std::pair<const char*, const char*> same[] = {
        {"2024-06-21 12:00", "2024-06-21T12:00Z"},
        {"2024-06-21t12:00z", "2024-06-21T12:00Z"},
        {"2024-06-21   12:00:30 Z", "2024-06-21T12:00:30Z"},
        {" 2024-06-21 12:00 ", "2024-06-21T12:00Z"},
        {"2024-06-21 12:00 UTC", "2024-06-21T12:00Z"},
        {"2024-06-21 12:00 gmt", "2024-06-21T12:00Z"},
        {"2024-06-21 12:00 UT", "2024-06-21T12:00Z"},
        {"2024-06-21 12:00 UTC+2", "2024-06-21T10:00Z"},
        {"2024-06-21 12:00 GMT-11", "2024-06-21T23:00Z"},
        {"2024-06-21 12:00UTC+5:30", "2024-06-21T06:30Z"},
        {"2024-06-21 12:00 UTC +02:00", "2024-06-21T10:00Z"},
        {"2024-06-21T1200Z", "2024-06-21T12:00Z"},
        {"20240621T120030Z", "2024-06-21T12:00:30Z"},
        {"20240621 1200 +0200", "2024-06-21T10:00Z"},
        {"20240621t120030.25", "2024-06-21T12:00:30.25Z"},
        {"2024-06-21T12:00+0200", "2024-06-21T10:00Z"},
        {"2024-06-21 12:00:00.5 -03", "2024-06-21T15:00:00.5Z"},
        {"2024-06-21 12:00 +05:45", "2024-06-21T06:15Z"},
        {"2024-06-21T12:00:00,250Z", "2024-06-21T12:00:00.250Z"},
        {"2024-06-21T12:00:00.123456789Z", "2024-06-21T12:00:00.123Z"},
        {"2024-06-21T24:00", "2024-06-22T00:00Z"},
        {"2024-02-28 24:00:00Z", "2024-02-29T00:00Z"},
        {"2023-12-31T24:00-01:00", "2024-01-01T01:00Z"},
        {"2101-01-01T00:30+01:00", ""}, // the year as it is written counts
        {"2100-12-31T24:00+00:30", "2100-12-31T23:30Z"},
    };
    for (const auto& [text, iso] : same)
    {
        UtcTime time;
        if (*iso)
            EXPECT_EQ(toString(at(text)), toString(at(iso))) << text;
        else
            EXPECT_NE(readUtcTime(text, time), "") << text;
    }
}

TEST(UtcTime, SaysWhatIsWrong)
{
    const std::pair<const char*, const char*> wrong[] = {
        {"2024-06-21", "there is no time of day"},
        {"2024-06-21T", "there is no time of day"},
        {"2024-06-21 ", "there is no time of day"},
        {"21.06.2024 12:00", "does not begin with a date"},
        {"6/21/2024 12:00", "does not begin with a date"},
        {"202406211T1200Z", "does not begin with a date"},
        {"2024-06-21T12:3000", "two digits, such as 09:30"},
        {"2024-06-21T1200:30", "\":30\" follows the time"},
        {"2024-06-21T12000Z", "seconds need two digits"},
        {"2024-06-21T12:00.5Z", "\".5Z\" follows the time"}, // of a minute, by ISO 8601
        {"2024-06-21T12:00 UTC+24", "the zone's hour 24 is not one of 0 ... 23"},
        {"2024-06-21T12:00 Z+02", "\"+02\" follows the time"},
        {"2024-06-211 2:00", "does not begin with a date"},
        {"2024-06-21_12:00", "not parted by a T or a blank"},
        {"2024-06-21 9:30", "two digits, such as 09:30"},
        {"2024-06-21 12.30", "two digits, such as 09:30"},
        {"2024-13-21 12:00", "month 13 is not one of 1 ... 12"},
        {"2024-06-31 12:00", "this month has no day 31"},
        {"2023-02-29 12:00", "this month has no day 29"},
        {"2101-06-21 12:00", "year 2101 is not one of 1900 ... 2100"},
        {"2024-06-21 25:00", "hour 25 is not one of 0 ... 24"},
        {"2024-06-21 24:01", "24:00 is the last moment of a day"},
        {"2024-06-21 24:00:00.001", "24:00 is the last moment of a day"},
        {"2024-06-21 12:61", "minute 61 is not one of 0 ... 59"},
        {"2016-12-31T23:59:60Z", "second 60 is not one of 0 ... 59"},
        {"2024-06-21T12:00:5", "seconds need two digits"},
        {"2024-06-21T12:00:05.Z", "fraction of a second has no digits"},
        {"2024-06-21T12:00 pm", "without am and pm"},
        {"2024-06-21T12:00 CEST", "not by name"},
        {"2024-06-21T12:00+2", "zone needs hours of two digits"},
        {"2024-06-21T12:00+020", "zone needs minutes of two digits"},
        {"2024-06-21T12:00+24:00", "the zone's hour 24 is not one of 0 ... 23"},
        {"2024-06-21T12:00+02:60", "the zone's minute 60 is not one of 0 ... 59"},
        {"2024-06-21T12:00Z 2024", "\"2024\" follows the time"},
        {"2100-12-31T24:00Z", "in UTC it is outside of these years"},
        {"1900-01-01T00:00+00:30", "in UTC it is outside of these years"},
    };
    for (const auto& [text, reason] : wrong)
    {
        UtcTime time;
        const std::string said = readUtcTime(text, time);
        EXPECT_EQ(said.rfind("\"" + std::string(text) + "\": needs a time YYYY-MM-DDThh:mm", 0), 0u)
            << said;
        EXPECT_NE(said.find(reason), std::string::npos) << said;
        EXPECT_EQ(time, UtcTime()) << text;
    }
}
