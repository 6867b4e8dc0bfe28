#include "io/RasterWriter.h"

#include "io/GdalErrors.h"
#include "io/PendingFile.h"
#include "io/RasterDriver.h"
#include "io/WrittenFile.h"

#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace osgTerrainLight
{
namespace
{

std::string size(int width, int height)
{
    return std::to_string(width) + " x " + std::to_string(height);
}

bool exists(const std::string& path)
{
    VSIStatBufL stat;
    return VSIStatExL(path.c_str(), &stat, VSI_STAT_EXISTS_FLAG) == 0;
}

CPLStringList optionList(const std::vector<std::string>& options)
{
    CPLStringList list;
    for (const std::string& option : options)
        list.AddString(option.c_str());
    return list;
}

/// What every driver is told before pixels are written.
Status describe(const std::string& path, GDALDataset& dataset, const RasterFrame& frame,
                const RasterWriteOptions& options, const GdalErrors& errors)
{
    if (frame.hasGeoTransform)
    {
        std::array<double, 6> transform = frame.geoTransform;
        if (dataset.SetGeoTransform(transform.data()) != CE_None)
            return Error{ErrorCode::Failed,
                         path + ": cannot store the geotransform: " + errors.first()};
    }
    if (!frame.crs.empty())
    {
        OGRSpatialReference crs;
        if (crs.importFromWkt(frame.crs.c_str()) != OGRERR_NONE)
            return Error{ErrorCode::Invalid, path + ": the CRS given is not WKT"};
        crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        if (frame.coordinateEpoch > 0.0)
            crs.SetCoordinateEpoch(frame.coordinateEpoch);
        if (dataset.SetSpatialRef(&crs) != CE_None)
            return Error{ErrorCode::Failed, path + ": cannot store the CRS: " + errors.first()};
    }
    for (const auto& [key, value] : options.metadata)
        dataset.SetMetadataItem(key.c_str(), value.c_str());
    return Nothing{};
}

/// The frame of the same pixels with the first row north and the first column west.
RasterFrame upright(RasterFrame frame)
{
    std::array<double, 6>& t = frame.geoTransform;
    if (!frame.northUp)
    {
        t[3] += frame.height * t[5];
        t[5] = -t[5];
    }
    if (!frame.westFirst)
    {
        t[0] += frame.width * t[1];
        t[1] = -t[1];
    }
    frame.northUp = frame.westFirst = true;
    return frame;
}

/// One file from creation to its place: what bands and pictures have in common.
struct OutputFile
{
    OutputFile(const std::string& path_, const RasterFrame& frame_,
               const RasterWriteOptions& options_)
        : path(path_), frame(frame_), options(options_), file(path_, options_.scratchFolder)
    {
    }
    ~OutputFile()
    {
        GdalErrors quiet;
        dataset.reset();
    }

    /// Creates the dataset that pixels go into: the file itself, or the source of a copy.
    Status create(int bandCount, GDALDataType type, bool copyOnly)
    {
        GdalErrors errors;
        if (frame.width < 1 || frame.height < 1 || bandCount < 1)
            return Error{ErrorCode::Invalid, path + ": " + size(frame.width, frame.height) +
                                                 " pixels in " + std::to_string(bandCount) +
                                                 " bands; needed at least one of each"};
        Result<GDALDriver*> found = findRasterDriver(path, options.driver);
        if (!found)
            return found.error();
        driver = *found;
        CPLStringList creation = optionList(options.creationOptions);
        // GDAL only warns of an option that it does not know, and goes on without it.
        if (!GDALValidateCreationOptions(driver, creation.List()))
            return Error{ErrorCode::Invalid, path + ": " + errors.first()};
        if (Status made = file.create(options.overwrite); !made)
            return made;
        written.emplace(frame.width, frame.height, bandCount);
        bytes = double(frame.width) * frame.height * bandCount * GDALGetDataTypeSizeBytes(type);

        copies = copyOnly || !driver->GetMetadataItem(GDAL_DCAP_CREATE);
        GDALDriver* creator = driver;
        std::string target = file.path();
        if (copies)
        {
            const bool inMemory = bytes <= 256.0 * 1024.0 * 1024.0;
            creator = GetGDALDriverManager()->GetDriverByName(inMemory ? "MEM" : "GTiff");
            scratch = inMemory ? "" : file.inside(".copied.tif");
            target = scratch;
            creation.Clear();
            if (!inMemory)
                for (const char* option : {"TILED=YES", "COMPRESS=DEFLATE", "ZLEVEL=1"})
                    creation.AddString(option);
        }
        if (EQUAL(creator->GetDescription(), "GTiff"))
        {
            // Bands come one by one; pixel-interleaved (GDAL's default), each would rewrite the
            // file.
            if (!creation.FetchNameValue("INTERLEAVE"))
                creation.SetNameValue("INTERLEAVE", "BAND");
            if (!creation.FetchNameValue("BIGTIFF"))
                creation.SetNameValue("BIGTIFF", "IF_SAFER");
        }
        dataset.reset(creator->Create(target.c_str(), frame.width, frame.height, bandCount, type,
                                      creation.List()));
        if (!dataset)
            return failed("cannot be created", errors);
        if (dataset->GetRasterBand(1)->GetRasterDataType() != type)
            return Error{ErrorCode::NotSupported, path + ": GDAL's driver \"" +
                                                      driver->GetDescription() + "\" has no " +
                                                      GDALGetDataTypeName(type) + " bands"};
        return describe(path, *dataset, frame, options, errors);
    }

    Error failed(const std::string& what, const std::string& said) const
    {
        const std::string reason = file.reason(said, bytes);
        return {ErrorCode::Failed,
                path + ": " + what + ": " + (reason.empty() ? "GDAL gives no reason" : reason)};
    }
    Error failed(const std::string& what, const GdalErrors& errors) const
    {
        return failed(what, errors.hasMessage() ? errors.first() : std::string());
    }

    /// Completes the file in its hidden folder and holds it against what was to be written. Return
    /// codes count, and what can be read again: messages may be of no failure, and closing, which
    /// writes what is still cached, gives nothing else.
    Status complete()
    {
        GdalErrors errors;
        if (copies)
        {
            // Strict: a driver that would drop bands or turn heights into bytes must fail instead.
            dataset->FlushCache(false);
            const CPLStringList creation = optionList(options.creationOptions);
            GDALDatasetUniquePtr copy(driver->CreateCopy(file.path().c_str(), dataset.get(), TRUE,
                                                         creation.List(), nullptr, nullptr));
            if (!copy)
                return failed(std::string("cannot be written as ") + driver->GetDescription(),
                              errors);
            copy.reset();
        }
        dataset.reset();
        if (!scratch.empty())
            VSIUnlink(scratch.c_str());
        const std::string said = message.empty() && errors.hasFailure() ? errors.first() : message;
        if (!exists(file.path()))
            return failed("cannot be completed", said.empty() ? std::string("GDAL's driver \"") +
                                                                    driver->GetDescription() +
                                                                    "\" wrote no file of that name"
                                                              : said);
        // A sidecar that is missing leaves a file that reads well, without its place.
        if (const std::string lost = errors.warningWith("Unable to save auxiliary information");
            !lost.empty())
            return Error{ErrorCode::Failed,
                         path + ": cannot be completed: " + file.reason(lost, 1.0, ".aux.xml")};
        const bool exact = WrittenFile::isExact(*driver, options.creationOptions);
        if (const Status same = written->compare(file.path(), *driver, exact); !same)
            return failed("cannot be completed", said.empty() ? same.error().message : said);
        return Nothing{};
    }
    Status finish()
    {
        const Status completed = complete();
        return completed ? file.commit() : completed;
    }

    /// Of the complete file.
    bool keepsEpoch() const
    {
        if (!(frame.coordinateEpoch > 0.0) || frame.crs.empty())
            return true;
        const GdalErrors quiet;
        const GDALDatasetUniquePtr read(GDALDataset::Open(file.path().c_str(), GDAL_OF_RASTER));
        const OGRSpatialReference* crs = read ? read->GetSpatialRef() : nullptr;
        return crs && std::abs(crs->GetCoordinateEpoch() - frame.coordinateEpoch) < 1e-6;
    }

    std::string path;
    RasterFrame frame;
    RasterWriteOptions options;
    GDALDriver* driver = nullptr;
    std::optional<WrittenFile> written; ///< what went into it
    double bytes = 0.0;                 ///< of the pixels as they are
    std::string message;                ///< the first failure that GDAL only spoke of
    bool copies = false;
    std::string scratch;
    // Closed before its folder is removed: destruction runs upwards.
    PendingFile file;
    GDALDatasetUniquePtr dataset;
};

} // namespace

struct RasterWriter::State : OutputFile
{
    using OutputFile::OutputFile;

    Status put(int band, int firstRow, std::vector<float>& values);

    std::map<int, int> done; ///< rows by band
    bool broken = false;
};

RasterWriter::RasterWriter(std::unique_ptr<State> state) : _state(std::move(state)) {}
RasterWriter::RasterWriter(RasterWriter&& other) noexcept = default;
RasterWriter& RasterWriter::operator=(RasterWriter&& other) noexcept = default;
RasterWriter::~RasterWriter() = default;

Result<RasterWriter> RasterWriter::open(const std::string& path, const RasterFrame& frame,
                                        const std::vector<BandLabel>& bands,
                                        const RasterWriteOptions& options)
{
    auto state = std::make_unique<State>(path, frame, options);
    if (Status created = state->create(static_cast<int>(bands.size()), GDT_Float32, false);
        !created)
        return created.error();
    // Labels before pixels: a TIFF's directory is then written once. A driver that has no place for
    // one puts it into a sidecar file.
    GdalErrors errors;
    for (std::size_t i = 0; i < bands.size(); ++i)
    {
        GDALRasterBand& band = *state->dataset->GetRasterBand(static_cast<int>(i) + 1);
        if (band.SetNoDataValue(static_cast<double>(noData)) != CE_None)
            return state->failed("cannot store the nodata value", errors);
        if (!bands[i].description.empty())
            band.SetDescription(bands[i].description.c_str());
        if (!bands[i].unit.empty())
            band.SetUnitType(bands[i].unit.c_str());
    }
    return RasterWriter(std::move(state));
}

/// Whole rows of a band, in the file's order; a row is done once.
Status RasterWriter::State::put(int band, int firstRow, std::vector<float>& values)
{
    GdalErrors errors;
    GDALRasterBand& target = *dataset->GetRasterBand(band);
    const int rows = static_cast<int>(values.size() / static_cast<std::size_t>(frame.width));
    std::size_t i = 0;
    for (int row = firstRow; row < firstRow + rows; ++row)
        for (int column = 0; column < frame.width; ++column, ++i)
        {
            if (std::isnan(values[i]))
                values[i] = noData;
            written->add(band, row, static_cast<double>(values[i]), values[i] == noData);
        }
    done[band] += rows;
    // To the file now: what stays in the block cache would fail at another band's turn.
    if (target.RasterIO(GF_Write, 0, firstRow, frame.width, rows, values.data(), frame.width, rows,
                        GDT_Float32, 0, 0, nullptr) != CE_None ||
        (done[band] == frame.height && target.FlushCache(false) != CE_None))
    {
        broken = true;
        return failed("cannot write band " + std::to_string(band), errors);
    }
    if (message.empty() && errors.hasFailure())
        message = errors.first();
    return Nothing{};
}

Status RasterWriter::checkRows(int band, int rows) const
{
    if (!_state || _state->broken)
        return Error{ErrorCode::Failed, (_state ? _state->path + ": " : std::string()) +
                                            "nothing can be written after a failure or the end"};
    const int count = _state->dataset->GetRasterCount();
    const auto found = _state->done.find(band);
    const int done = found == _state->done.end() ? 0 : found->second;
    if (band < 1 || band > count || done + rows > _state->frame.height)
        return Error{ErrorCode::Invalid, _state->path + ": band " + std::to_string(band) + " of " +
                                             std::to_string(count) +
                                             " is written already or does not exist"};
    return Nothing{};
}

Status RasterWriter::writeBand(int band, const Raster<float>& values)
{
    if (Status legal = checkRows(band, _state ? _state->frame.height : 0); !legal)
        return legal;
    const RasterFrame& frame = _state->frame;
    if (values.width() != frame.width || values.height() != frame.height)
        return Error{ErrorCode::Invalid, _state->path + ": band " + std::to_string(band) + " has " +
                                             size(values.width(), values.height()) +
                                             " values; needed " + size(frame.width, frame.height)};
    const int stripRows = std::max(1, (1 << 20) / frame.width);
    std::vector<float> strip;
    for (int first = 0; first < frame.height; first += stripRows)
    {
        strip.clear();
        for (int row = first; row < std::min(first + stripRows, frame.height); ++row)
            for (int column = 0; column < frame.width; ++column)
                strip.push_back(values.at(frame.fileColumn(column), frame.fileRow(row)));
        if (Status put = _state->put(band, first, strip); !put)
            return put;
    }
    return Nothing{};
}

Status RasterWriter::writeRows(int band, int firstRow, const std::vector<float>& values)
{
    const std::size_t width = _state ? static_cast<std::size_t>(_state->frame.width) : 1;
    const int rows = static_cast<int>(values.size() / width);
    if (Status legal = checkRows(band, rows); !legal)
        return legal;
    if (values.empty() || values.size() % width != 0 || firstRow < 0 ||
        firstRow > _state->frame.height - rows)
        return Error{ErrorCode::Invalid, _state->path + ": " + std::to_string(values.size()) +
                                             " values are no rows of " +
                                             size(_state->frame.width, _state->frame.height)};
    std::vector<float> strip = values;
    return _state->put(band, firstRow, strip);
}

int RasterWriter::blockRows() const
{
    int width = 1;
    int height = 1;
    if (_state)
        _state->dataset->GetRasterBand(1)->GetBlockSize(&width, &height);
    return height;
}

Result<std::unique_ptr<RasterWriter::State>> RasterWriter::end()
{
    if (!_state || _state->broken)
        return Error{ErrorCode::Failed, (_state ? _state->path + ": " : std::string()) +
                                            "nothing can be written after a failure or the end"};
    std::unique_ptr<State> state = std::move(_state);
    const int bands = state->dataset->GetRasterCount();
    const auto complete =
        std::count_if(state->done.begin(), state->done.end(),
                      [&](const auto& band) { return band.second == state->frame.height; });
    if (complete != bands)
        return Error{ErrorCode::Invalid, state->path + ": only " + std::to_string(complete) +
                                             " of " + std::to_string(bands) +
                                             " bands were written"};
    return state;
}

Status RasterWriter::finish()
{
    const Result<std::unique_ptr<State>> state = end();
    return state ? (*state)->finish() : Status(state.error());
}

Result<bool> RasterWriter::rehearse()
{
    const Result<std::unique_ptr<State>> state = end();
    if (!state)
        return state.error();
    if (const Status completed = (*state)->complete(); !completed)
        return completed.error();
    return (*state)->keepsEpoch();
}

Status writeRaster(const std::string& path, const RasterFrame& frame,
                   const std::vector<RasterBand>& bands, const RasterWriteOptions& options)
{
    std::vector<BandLabel> labels;
    for (const RasterBand& band : bands)
        labels.push_back(band.label);
    Result<RasterWriter> writer = RasterWriter::open(path, frame, labels, options);
    if (!writer)
        return writer.error();
    for (std::size_t i = 0; i < bands.size(); ++i)
        if (Status written = writer->writeBand(static_cast<int>(i) + 1, bands[i].values); !written)
            return written;
    return writer->finish();
}

Status writeRgb8(const std::string& path, const RasterFrame& frame, int channels,
                 const PixelRows& rows, const RasterWriteOptions& options)
{
    OutputFile output(path, upright(frame), options);
    // Always by copy: how a driver is told of colours differs, but they all know them from a
    // source.
    if (Status created = output.create(channels, GDT_Byte, true); !created)
        return created;
    GdalErrors errors;
    constexpr GDALColorInterp colours[] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_AlphaBand};
    for (int channel = 0; channel < channels; ++channel)
        output.dataset->GetRasterBand(channel + 1)->SetColorInterpretation(colours[channel]);
    const std::size_t stride = static_cast<std::size_t>(channels);
    std::vector<std::uint8_t> pixels;
    std::vector<std::uint8_t> line(static_cast<std::size_t>(frame.width));
    for (int row = 0; row < frame.height; ++row)
    {
        if (Status read = rows(row, pixels); !read)
            return read;
        if (pixels.size() != stride * line.size())
            return Error{ErrorCode::Invalid, path + ": " + std::to_string(pixels.size()) +
                                                 " bytes for a row of " +
                                                 std::to_string(frame.width) + " pixels"};
        for (std::size_t channel = 0; channel < stride; ++channel)
        {
            const int number = static_cast<int>(channel) + 1;
            for (std::size_t i = 0; i < line.size(); ++i)
            {
                line[i] = pixels[i * stride + channel];
                output.written->add(number, row, line[i], false);
            }
            if (output.dataset->GetRasterBand(number)->RasterIO(GF_Write, 0, row, frame.width, 1,
                                                                line.data(), frame.width, 1,
                                                                GDT_Byte, 0, 0, nullptr) != CE_None)
                return output.failed("cannot be written", errors);
        }
    }
    return output.finish();
}

Status writeRgb8(const std::string& path, const RasterFrame& frame,
                 const std::vector<std::uint8_t>& pixels, const RasterWriteOptions& options)
{
    const std::size_t count =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    const std::size_t channels = count > 0 ? pixels.size() / count : 0;
    if ((channels != 3 && channels != 4) || pixels.size() != channels * count)
        return Error{ErrorCode::Invalid,
                     path + ": " + std::to_string(pixels.size()) + " bytes for a picture of " +
                         size(frame.width, frame.height) + "; needed 3 or 4 per pixel"};
    const std::size_t bytes = channels * static_cast<std::size_t>(frame.width);
    const auto rows = [&](int row, std::vector<std::uint8_t>& line) -> Status
    {
        const auto first =
            static_cast<std::ptrdiff_t>(static_cast<std::size_t>(frame.height - 1 - row) * bytes);
        line.assign(pixels.begin() + first,
                    pixels.begin() + first + static_cast<std::ptrdiff_t>(bytes));
        return Nothing{};
    };
    return writeRgb8(path, frame, static_cast<int>(channels), rows, options);
}

} // namespace osgTerrainLight
