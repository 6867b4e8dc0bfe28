# What find_package(osgTerrainLight) reads: target osgTerrainLight::osgTerrainLight.
include(CMakePackageConfigHelpers)
set(OTL_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/osgTerrainLight)
set(OTL_SHADER_DIR ${CMAKE_INSTALL_DATADIR}/osgTerrainLight)

# The name that a project uses which adds our sources as a sub-directory.
add_library(osgTerrainLight::osgTerrainLight ALIAS osgTerrainLight)

# OSG's paths on the machine that builds stay out of the exported target; the config file looks
# them up anew.
get_target_property(otl_libraries osgTerrainLight INTERFACE_LINK_LIBRARIES)
set_property(TARGET osgTerrainLight PROPERTY INTERFACE_LINK_LIBRARIES
             "$<BUILD_INTERFACE:${otl_libraries}>")
foreach(property INTERFACE_INCLUDE_DIRECTORIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES)
  get_target_property(otl_folders osgTerrainLight ${property})
  list(REMOVE_ITEM otl_folders ${OPENSCENEGRAPH_INCLUDE_DIRS})
  set_property(TARGET osgTerrainLight PROPERTY ${property} ${otl_folders}
               "$<BUILD_INTERFACE:${OPENSCENEGRAPH_INCLUDE_DIRS}>")
endforeach()

configure_package_config_file(osgTerrainLightConfig.cmake.in osgTerrainLightConfig.cmake
                              INSTALL_DESTINATION ${OTL_PACKAGE_DIR} PATH_VARS OTL_SHADER_DIR)
# Before 1.0 a minor version may break callers: the shared library's name holds it too.
write_basic_package_version_file(osgTerrainLightConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(EXPORT osgTerrainLightTargets NAMESPACE osgTerrainLight:: DESTINATION ${OTL_PACKAGE_DIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/osgTerrainLightConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/osgTerrainLightConfigVersion.cmake
        DESTINATION ${OTL_PACKAGE_DIR})
