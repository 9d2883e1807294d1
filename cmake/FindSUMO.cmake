# Finds libsumo and libtraci where SUMO brings no CMake config of its own.
# Defines SUMO::libsumocpp and SUMO::libtracicpp, the names of SUMO's config.
find_path(SUMO_INCLUDE_DIR libsumo/libsumo.h
  HINTS ENV SUMO_HOME PATH_SUFFIXES include src)
find_library(SUMO_LIBSUMOCPP NAMES sumocpp HINTS ENV SUMO_HOME PATH_SUFFIXES lib bin)
find_library(SUMO_LIBTRACICPP NAMES tracicpp HINTS ENV SUMO_HOME PATH_SUFFIXES lib bin)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SUMO
  REQUIRED_VARS SUMO_LIBSUMOCPP SUMO_LIBTRACICPP SUMO_INCLUDE_DIR)

if(SUMO_FOUND)
  foreach(name IN ITEMS libsumocpp libtracicpp)
    string(TOUPPER ${name} upper)
    add_library(SUMO::${name} UNKNOWN IMPORTED)
    set_target_properties(SUMO::${name} PROPERTIES
      IMPORTED_LOCATION ${SUMO_${upper}}
      INTERFACE_INCLUDE_DIRECTORIES ${SUMO_INCLUDE_DIR})
  endforeach()
endif()
