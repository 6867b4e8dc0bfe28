#include "io/RasterDriver.h"

#include <cpl_string.h>
#include <gdal_priv.h>

#include <filesystem>

namespace osgTerrainLight
{

namespace
{
bool writes(GDALDriver& driver)
{
    return driver.GetMetadataItem(GDAL_DCAP_RASTER) &&
           (driver.GetMetadataItem(GDAL_DCAP_CREATE) ||
            driver.GetMetadataItem(GDAL_DCAP_CREATECOPY)) &&
           !EQUAL(driver.GetDescription(), "MEM");
}

bool hasExtension(GDALDriver& driver, const char* extension)
{
    const char* all = driver.GetMetadataItem(GDAL_DMD_EXTENSIONS);
    if (!all)
        all = driver.GetMetadataItem(GDAL_DMD_EXTENSION);
    const CPLStringList extensions(CSLTokenizeString(all ? all : ""));
    return extensions.FindString(extension) >= 0;
}
} // namespace

Result<GDALDriver*> findRasterDriver(const std::string& path, const std::string& name)
{
    GDALDriverManager& manager = *GetGDALDriverManager();
    if (!name.empty())
    {
        GDALDriver* driver = manager.GetDriverByName(name.c_str());
        if (!driver)
            return Error{ErrorCode::NotSupported, path + ": GDAL has no driver \"" + name +
                                                      "\"; gdalinfo --formats lists those it has"};
        if (!writes(*driver))
            return Error{ErrorCode::NotSupported,
                         path + ": GDAL's driver \"" + name + "\" does not write raster files"};
        return driver;
    }
    std::string extension = std::filesystem::path(path).extension().string();
    extension.erase(0, 1); // its full stop
    // As GDAL's own tools: the first registered; GTiff before COG, netCDF before GMT, by that order
    // or by name.
    if (extension.empty())
        return manager.GetDriverByName("GTiff");
    if (EQUAL(extension.c_str(), "nc"))
        if (GDALDriver* driver = manager.GetDriverByName("netCDF"))
            return driver;
    for (int i = 0; i < manager.GetDriverCount(); ++i)
    {
        GDALDriver* driver = manager.GetDriver(i);
        if (writes(*driver) && hasExtension(*driver, extension.c_str()))
            return driver;
    }
    return Error{ErrorCode::NotSupported,
                 path + ": no GDAL driver writes ." + extension +
                     " files; needed another extension or a driver's name"};
}

} // namespace osgTerrainLight
