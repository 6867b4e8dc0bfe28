// Times as text: readUtcTime() and toString(UtcTime) of SunPosition.h.
#include <osgTerrainLight/SunPosition.h>

#include <erfa.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace osgTerrainLight
{

namespace
{
using namespace std::chrono;
constexpr int unixEpoch = 40587; ///< modified Julian Date of 1970-01-01
constexpr double julianOfModified = 2'400'000.5;
constexpr int firstYear = 1900, lastYear = 2100;

bool isDigit(char c)
{
    return c >= '0' && c <= '9';
}

bool isLetter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// Takes a text apart from its front; every step says whether it could.
class Scanner
{
public:
    explicit Scanner(std::string_view text) : _rest(text) {}

    /// Exactly so many digits.
    bool number(std::size_t digits, int& value)
    {
        if (_rest.size() < digits ||
            !std::all_of(_rest.begin(), _rest.begin() + static_cast<std::ptrdiff_t>(digits),
                         isDigit))
            return false;
        std::from_chars(_rest.data(), _rest.data() + digits, value);
        _rest.remove_prefix(digits);
        return true;
    }
    bool one(std::string_view of)
    {
        if (_rest.empty() || of.find(_rest.front()) == std::string_view::npos)
            return false;
        _rest.remove_prefix(1);
        return true;
    }
    /// The letters that come next, in lower case.
    std::string word()
    {
        std::string letters;
        for (; isLetter(next()); _rest.remove_prefix(1))
            letters += lower(next());
        return letters;
    }
    bool blanks()
    {
        const std::size_t before = _rest.size();
        while (one(" \t"))
        {
        }
        return _rest.size() < before;
    }
    /// Digits of a fraction of a second, in milliseconds, what is finer cut off.
    bool fraction(int& value)
    {
        std::size_t digits = 0;
        for (value = 0; isDigit(next()); ++digits, _rest.remove_prefix(1))
            if (digits < 3)
                value = 10 * value + (next() - '0');
        for (std::size_t i = digits; i < 3; ++i)
            value *= 10;
        return digits > 0;
    }
    char next() const { return _rest.empty() ? '\0' : _rest.front(); }
    std::string_view rest() const { return _rest; }

private:
    std::string_view _rest;
};

std::string outOf(const char* what, int value, int first, int last)
{
    return std::string(what) + " " + std::to_string(value) + " is not one of " +
           std::to_string(first) + " ... " + std::to_string(last);
}

/// What is wrong, or empty; days since the epoch.
std::string scanDate(Scanner& scan, std::int64_t& days)
{
    int year = 0, month = 0, day = 0;
    bool parted = false; // 2024-06-21, not 20240621
    if (!scan.number(4, year) || (parted = scan.one("-"), !scan.number(2, month)) ||
        scan.one("-") != parted || !scan.number(2, day) || isDigit(scan.next()))
        return "it does not begin with a date, such as 2024-06-21";
    if (year < firstYear || year > lastYear)
        return outOf("year", year, firstYear, lastYear);
    if (month < 1 || month > 12)
        return outOf("month", month, 1, 12);
    double epoch = 0.0, date = 0.0;
    if (eraCal2jd(year, month, day, &epoch, &date) != 0)
        return "this month has no day " + std::to_string(day);
    days = std::llround(date) - unixEpoch;
    return {};
}

/// What is wrong, or empty; since midnight, up to 24:00.
std::string scanClock(Scanner& scan, milliseconds& time)
{
    int hour = 0, minute = 0, second = 0, millisecond = 0;
    bool parted = false; // 12:00:30, not 120030
    if (!scan.number(2, hour) || (parted = scan.one(":"), !scan.number(2, minute)) ||
        (parted && isDigit(scan.next())))
        return "the time of day does not begin with hours and minutes of two digits, such as "
               "09:30";
    const bool hasSeconds = parted ? scan.one(":") : isDigit(scan.next());
    if (hasSeconds && (!scan.number(2, second) || isDigit(scan.next())))
        return "seconds need two digits";
    if (hasSeconds && scan.one(".,") && !scan.fraction(millisecond))
        return "the fraction of a second has no digits";
    if (hour > 24)
        return outOf("hour", hour, 0, 24);
    if (minute > 59)
        return outOf("minute", minute, 0, 59);
    if (second > 59)
        return outOf("second", second, 0, 59);
    time = hours(hour) + minutes(minute) + seconds(second) + milliseconds(millisecond);
    if (time > hours(24))
        return "24:00 is the last moment of a day";
    return {};
}

/// What is wrong, or empty; how much the zone is before UTC. shortHour: whether its hour may have
/// one digit, as in UTC+2.
std::string scanOffset(Scanner& scan, bool shortHour, minutes& zone)
{
    const bool behind = scan.next() == '-';
    if (!scan.one("+-"))
        return {};
    int hour = 0, minute = 0;
    if (!scan.number(2, hour) && !(shortHour && scan.number(1, hour)))
        return "the zone needs hours of two digits, such as +02:00";
    if ((scan.one(":") || isDigit(scan.next())) && !scan.number(2, minute))
        return "the zone needs minutes of two digits, such as +05:30";
    if (hour > 23)
        return outOf("the zone's hour", hour, 0, 23);
    if (minute > 59)
        return outOf("the zone's minute", minute, 0, 59);
    zone = (behind ? -1 : 1) * (hours(hour) + minutes(minute));
    return {};
}

/// As scanOffset(), with the names that stand for UTC.
std::string scanZone(Scanner& scan, minutes& zone)
{
    const std::string name = scan.word();
    if (name == "am" || name == "pm")
        return "hours count from 0 to 24, without am and pm";
    const bool universal = name == "utc" || name == "gmt" || name == "ut";
    if (!name.empty() && name != "z" && !universal)
        return "zones are known by their offset alone, such as +02:00, not by name";
    if (universal)
        scan.blanks();
    return name == "z" ? std::string() : scanOffset(scan, universal, zone);
}

/// What is wrong, or empty and the time.
std::string scan(std::string_view text, UtcTime& time)
{
    Scanner scan(text);
    scan.blanks();
    std::int64_t days = 0;
    if (const std::string wrong = scanDate(scan, days); !wrong.empty())
        return wrong;
    const bool parted = scan.one("Tt") || scan.blanks();
    if (scan.rest().empty())
        return "there is no time of day";
    if (!parted)
        return "date and time of day are not parted by a T or a blank";
    milliseconds clock{0};
    if (const std::string wrong = scanClock(scan, clock); !wrong.empty())
        return wrong;
    scan.blanks();
    minutes zone{0};
    if (const std::string wrong = scanZone(scan, zone); !wrong.empty())
        return wrong;
    scan.blanks();
    if (!scan.rest().empty())
        return "\"" + std::string(scan.rest()) + "\" follows the time";
    const UtcTime found = UtcTime(hours(24 * days)) + clock - zone;
    // Of UTC, too, which a zone or 24:00 can carry past the years.
    constexpr std::int64_t firstDay = -25567, endDay = 47847; // 1900-01-01, 2101-01-01
    if (found < UtcTime(hours(24 * firstDay)) || found >= UtcTime(hours(24 * endDay)))
        return "in UTC it is outside of these years";
    time = found;
    return {};
}
} // namespace

std::string readUtcTime(const std::string& text, UtcTime& time)
{
    const std::string wrong = scan(text, time);
    return wrong.empty() ? std::string()
                         : "\"" + text +
                               "\": needs a time YYYY-MM-DDThh:mm[:ss[.sss]][Z|+hh:mm], years "
                               "1900 ... 2100, such as 2024-06-21T10:30Z; " +
                               wrong;
}

std::string toString(UtcTime time)
{
    const std::int64_t all = time.time_since_epoch().count();
    constexpr std::int64_t perDay = milliseconds(hours(24)).count();
    const std::int64_t days = (all - (all % perDay + perDay) % perDay) / perDay;
    const int millisecond = static_cast<int>(all - days * perDay);
    int year = 0, month = 0, day = 0;
    double fraction = 0.0;
    eraJd2cal(julianOfModified, static_cast<double>(unixEpoch + days), &year, &month, &day,
              &fraction);
    const int second = millisecond / 1000;
    std::array<char, 64> digits{};
    std::snprintf(digits.data(), digits.size(), "%04d-%02d-%02dT%02d:%02d:%02d", year, month, day,
                  second / 3600, second / 60 % 60, second % 60);
    std::string result = digits.data();
    std::snprintf(digits.data(), digits.size(), ".%03d", millisecond % 1000);
    return result + (millisecond % 1000 ? digits.data() : "") + "Z";
}

} // namespace osgTerrainLight
