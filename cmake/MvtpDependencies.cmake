# Packages with a good CMake target are used by it; the others get one here, once.
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(fcl REQUIRED)
find_package(ompl REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(ZLIB REQUIRED)

# fcl's own target names neither Eigen nor its headers as system headers.
add_library(mvtp_fcl INTERFACE)
add_library(mvtp::fcl ALIAS mvtp_fcl)
target_link_libraries(mvtp_fcl INTERFACE fcl Eigen3::Eigen)

# OMPL 1.5 exports variables only.
add_library(mvtp_ompl INTERFACE)
add_library(mvtp::ompl ALIAS mvtp_ompl)
target_include_directories(mvtp_ompl SYSTEM INTERFACE ${OMPL_INCLUDE_DIRS})
target_link_libraries(mvtp_ompl INTERFACE ${OMPL_LIBRARIES} Eigen3::Eigen)

if(MVTP_WITH_SUMO)
  find_package(SUMO CONFIG QUIET)
  if(NOT TARGET SUMO::libsumocpp)
    find_package(SUMO MODULE REQUIRED)
  endif()
  find_package(tinyxml2 REQUIRED)
endif()
if(MVTP_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
if(MVTP_BUILD_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
