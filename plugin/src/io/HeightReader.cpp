#include "io/HeightReader.h"

#include "io/GdalErrors.h"
#include "io/OpenDem.h"

#include <cpl_conv.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace osgTerrainLight
{
namespace
{
std::string number(double value)
{
    return CPLSPrintf("%.10g", value);
}

std::string countOfPosts(std::size_t count)
{
    return std::to_string(count) + (count == 1 ? " post" : " posts");
}
} // namespace

double originOfHeights(double lowest, double highest)
{
    return std::round(0.5 * (lowest + highest)) + 0.0; // never -0
}

std::string noteOfSlopes(const GroundSpacing& ground, double lowest, double highest)
{
    constexpr double degree = 3.14159265358979323846 / 180.0;
    const double error =
        ground.factors.steepest(ground.east[ground.east.size() / 2], ground.north) * 0.5 *
        (highest - lowest);
    if (error <= std::tan(0.1 * degree))
        return {};
    return std::string("the map's scale changes so much over the raster that slopes are wrong "
                       "by up to ") +
           CPLSPrintf("%.1f", std::atan(error) / degree) +
           " degrees; a smaller window or another projection is nearer";
}

std::optional<Error> tellOfBeyond(const std::string& path, std::size_t beyond, std::size_t all,
                                  std::vector<std::string>& notes)
{
    const std::string most =
        " more than 1e6 m from the middle height, by the z factor or the map's scale";
    if (beyond == all)
        return Error{ErrorCode::Invalid, path + ": all heights lie" + most};
    if (beyond > 0)
        notes.push_back(countOfPosts(beyond) + most + ": taken as void");
    return std::nullopt;
}

bool isBeyondPole(const GroundSpacing& ground, const RasterFrame& frame, int fileRow)
{
    return !ground.beyondPole.empty() &&
           ground.beyondPole[static_cast<std::size_t>(frame.fileRow(fileRow))];
}

template <class Real>
HeightReader<Real>::HeightReader(const OpenDem& dem)
    : _info(dem.info), _dataset(*dem.dataset), _band(dem.band), _maskBand(dem.band->GetMaskBand()),
      _customs(dem.info), _survey(dem.info.bodyRadius, !dem.info.heightUnit.empty())
{
    if (_info.alphaBand != 0)
        _maskBand = _dataset.GetRasterBand(_info.alphaBand);
}

template <class Real>
int HeightReader<Real>::width() const
{
    return _band->GetXSize();
}

template <class Real>
int HeightReader<Real>::height() const
{
    return _band->GetYSize();
}

template <class Real>
bool HeightReader<Real>::isNoData(Real stored) const
{
    if (!_info.noData)
        return false;
    if (std::isnan(*_info.noData))
        return std::isnan(stored);
    // A nodata value that text or a double tag holds exactly may have been rounded to float on its
    // way into the pixels, or the other way round. Large whole numbers must not be rounded.
    return static_cast<double>(stored) == *_info.noData ||
           (!_info.integer && static_cast<float>(stored) == static_cast<float>(*_info.noData));
}

template <class Real>
bool HeightReader<Real>::useOverview(int maxSide)
{
    GDALRasterBand* const whole = _band;
    GDALRasterBand* const alpha =
        _info.alphaBand != 0 ? _dataset.GetRasterBand(_info.alphaBand) : nullptr;
    for (int i = 0; i < whole->GetOverviewCount(); ++i)
    {
        GDALRasterBand* overview = whole->GetOverview(i);
        GDALRasterBand* mask = alpha ? alpha->GetOverview(i) : overview->GetMaskBand();
        const int columns = overview->GetXSize();
        const int rows = overview->GetYSize();
        const bool masked = mask && mask->GetXSize() == columns && mask->GetYSize() == rows;
        if (std::max(columns, rows) >= maxSide && columns <= width() && masked)
        {
            _band = overview;
            _maskBand = mask;
        }
    }
    return _band != whole;
}

template <class Real>
int HeightReader<Real>::stripRows(const PixelWindow& window) const
{
    int blockWidth = 0;
    int blockHeight = 0;
    _band->GetBlockSize(&blockWidth, &blockHeight);
    return std::clamp(blockHeight, 1, std::max(1, (1 << 22) / window.width));
}

template <class Real>
Error HeightReader<Real>::unreadable(const std::string& path, const PixelWindow& window,
                                     const GdalErrors& errors) const
{
    return Error{ErrorCode::Failed, path + ": cannot read rows " + std::to_string(window.row) +
                                        " to " + std::to_string(window.row + window.height - 1) +
                                        " of " + std::to_string(height()) + ": " + errors.last()};
}

template <class Real>
std::optional<Error>
HeightReader<Real>::eachStrip(const PixelWindow& window, bool lastFirst, const std::string& path,
                              const GdalErrors& errors, const std::function<bool(double)>& progress,
                              const std::function<bool(const PixelWindow& strip)>& take) const
{
    const int most = stripRows(window);
    const int end = window.row + window.height;
    for (int done = 0; done < window.height;)
    {
        PixelWindow strip = window;
        if (lastFirst) // strips begin and end where blocks do
        {
            const int last = end - done - 1;
            strip.row = std::max(window.row, last - last % most);
            strip.height = last + 1 - strip.row;
        }
        else
        {
            strip.row = window.row + done;
            strip.height = std::min(most - strip.row % most, end - strip.row);
        }
        if (!take(strip))
            return unreadable(path, strip, errors);
        done += strip.height;
        if (progress && !progress(static_cast<double>(done) / window.height))
            return Error{ErrorCode::Failed, path + ": reading was cancelled"};
    }
    return std::nullopt;
}

template <class Real>
bool HeightReader<Real>::read(const PixelWindow& window, Real* values, bool survey)
{
    const auto readBand = [&](GDALRasterBand* band, auto* to, GDALDataType type)
    {
        return band->RasterIO(GF_Read, window.column, window.row, window.width, window.height, to,
                              window.width, window.height, type, 0, 0, nullptr) == CE_None;
    };
    const std::size_t count =
        static_cast<std::size_t>(window.width) * static_cast<std::size_t>(window.height);
    if (!readBand(_band, values, sizeof(Real) == sizeof(float) ? GDT_Float32 : GDT_Float64))
        return false;
    _mask.resize(_info.hasMask ? count : 0);
    if (_info.hasMask && !readBand(_maskBand, _mask.data(), GDT_Float32))
        return false;
    for (std::size_t i = 0; i < count; ++i)
    {
        Real& value = values[i];
        if (_info.signedBytes && value > Real(127))
            value -= Real(256);
        if (isNoData(value) || (_info.hasMask && !(_mask[i] > 0.0f)))
            value = std::numeric_limits<Real>::quiet_NaN();
        else if (survey && !_customs.take(static_cast<double>(value)))
            _survey.add(_info.metresOf(static_cast<double>(value)));
    }
    return true;
}

template <class Real>
Result<HeightRules> HeightReader<Real>::rules(const std::string& path, const PixelWindow& window)
{
    for (const double value : _customs.heights())
        _survey.add(_info.metresOf(value));
    if (_survey.heights() > 0)
        return HeightRules{_customs.voids(), _survey.lowest(), _survey.highest(),
                           _survey.areKilometres(), _survey.radius()};
    std::string why;
    for (const std::string& note : voidNotes())
        why += "; " + note;
    return Error{ErrorCode::Invalid, path + ": holds no valid height: all of " +
                                         std::to_string(window.width) + " x " +
                                         std::to_string(window.height) + " posts are void" + why};
}

template <class Real>
std::vector<std::string> HeightReader<Real>::voidNotes() const
{
    std::vector<std::string> notes = _customs.notes();
    if (_survey.voids() > 0)
        notes.insert(notes.begin(),
                     countOfPosts(_survey.voids()) +
                         (_survey.areRadii()
                              ? " that are no radii of the body, half to one and a half of its own"
                              : " without a finite height within ±1e6 m") +
                         ": taken as void");
    return notes;
}

template <class Real>
std::vector<std::string> HeightReader<Real>::notes() const
{
    std::vector<std::string> notes;
    if (_survey.areRadii())
        notes.push_back("heights are radii of the body: its " + number(_survey.radius()) +
                        " m come off");
    if (_survey.areKilometres())
        notes.push_back("heights are radii of the body in kilometres: its " +
                        number(_survey.radius()) + " m come off; --unit m tells of metres");
    const std::vector<std::string> voids = voidNotes();
    notes.insert(notes.end(), voids.begin(), voids.end());
    return notes;
}

template class HeightReader<float>;
template class HeightReader<double>;

} // namespace osgTerrainLight
