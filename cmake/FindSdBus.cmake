# Finds systemd's D-Bus library. Defines SdBus::sdbus.
find_path(SDBUS_INCLUDE_DIR systemd/sd-bus.h)
find_library(SDBUS_LIBRARY NAMES systemd)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SdBus REQUIRED_VARS SDBUS_LIBRARY SDBUS_INCLUDE_DIR)

if(SdBus_FOUND AND NOT TARGET SdBus::sdbus)
  add_library(SdBus::sdbus UNKNOWN IMPORTED)
  set_target_properties(SdBus::sdbus PROPERTIES
    IMPORTED_LOCATION ${SDBUS_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${SDBUS_INCLUDE_DIR})
endif()
