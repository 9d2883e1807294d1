# The Debian packages: mvtp (programs, manual pages, completion), libmvtp-dev (the library), and
# python3-mvtp.
# tools/package.sh builds and checks them.
set(MVTP_MAINTAINER "mvtp maintainers <maintainers@mvtp.invalid>" CACHE STRING
  "Whom the packages name as their maintainer")

# Debian's own changelog has one entry: the version, with the date that CHANGELOG.md gives.
file(STRINGS ${PROJECT_SOURCE_DIR}/CHANGELOG.md release REGEX "^## ${PROJECT_VERSION} " LIMIT_COUNT 1)
if(NOT release MATCHES "([0-9]+-[0-9]+-[0-9]+)")
  message(FATAL_ERROR "CHANGELOG.md has no entry \"## ${PROJECT_VERSION} (YEAR-MONTH-DAY)\"")
endif()
execute_process(COMMAND date --utc --rfc-email --date=${CMAKE_MATCH_1}
  OUTPUT_VARIABLE MVTP_RELEASE_DATE OUTPUT_STRIP_TRAILING_WHITESPACE)
file(READ ${PROJECT_SOURCE_DIR}/LICENSE MVTP_LICENSE)

set(packages mvtp libmvtp-dev)
set(components mvtp development)
if(MVTP_BUILD_PYTHON)
  list(APPEND packages python3-mvtp)
  list(APPEND components python)
endif()
set(doc_dir ${PROJECT_BINARY_DIR}/package)
foreach(package IN LISTS packages)
  configure_file(cmake/package/changelog.in ${doc_dir}/${package}/changelog.Debian @ONLY)
  configure_file(cmake/package/copyright.in ${doc_dir}/${package}/copyright @ONLY)
  configure_file(cmake/package/lintian.in ${doc_dir}/lintian/${package} @ONLY)
  file(COPY_FILE ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${doc_dir}/${package}/changelog)
  execute_process(COMMAND gzip -9nf changelog changelog.Debian
    WORKING_DIRECTORY ${doc_dir}/${package})
endforeach()
foreach(package component IN ZIP_LISTS packages components)
  install(DIRECTORY ${doc_dir}/${package} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc
    COMPONENT ${component})
  install(FILES ${doc_dir}/lintian/${package} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
    COMPONENT ${component})
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "${MVTP_MAINTAINER}")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_MVTP_PACKAGE_NAME mvtp)
set(CPACK_DEBIAN_MVTP_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MVTP_DESCRIPTION
"Plans collision-free trajectories for many vehicles at once with ESCoT: at
the junctions and on the parking lots of a SUMO network in place of traffic
lights, on benchmark maps, and on toio cubes. An independent referee judges
every plan.")
set(CPACK_DEBIAN_MVTP_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MVTP_PACKAGE_RECOMMENDS "python3-matplotlib")
set(CPACK_DEBIAN_MVTP_PACKAGE_SUGGESTS
  "bluez, chromium-headless-shell | chromium, librsvg2-bin")
if(MVTP_WITH_SUMO)
  # libsumo and libtraci lie in Debian's package sumo, without a version of their interface.
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" sumo "${MVTP_SUMO_VERSION}")
  math(EXPR next "${CMAKE_MATCH_2} + 1")
  set(CPACK_DEBIAN_MVTP_PACKAGE_DEPENDS
    "sumo (>= ${sumo}), sumo (<< ${CMAKE_MATCH_1}.${next})")
endif()

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmvtp-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
"Headers and static libraries, to solve and judge instances, and to write
controllers of one's own, from C++. CMake finds it as mvtp, with the targets
mvtp::planner and mvtp::coordinator.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev, libfcl-dev, libfmt-dev, libompl-dev, libyaml-cpp-dev, libtbb-dev")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mvtp)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION
"Solves and judges instances, steps the coordinated traffic of a SUMO network,
also under controllers written in Python, and runs whole scenarios; plans are
NumPy arrays.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
if(MVTP_BUILD_PYTHON)
  math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "mvtp (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), \
python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${PROJECT_SOURCE_DIR}/cmake/package/python/postinst;${PROJECT_SOURCE_DIR}/cmake/package/python/prerm")
include(CPack)
