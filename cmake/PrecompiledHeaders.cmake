# Headers that many sources include, parsed once for all of them. They only save time: each source
# includes what it uses, and builds without them too (-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON).
set(standard_headers
  <algorithm> <array> <charconv> <chrono> <cmath> <cstddef> <cstdint> <cstring> <deque> <functional>
  <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <random> <ranges> <set> <span>
  <sstream> <string> <string_view> <tuple> <unordered_map> <utility> <vector>)

# mvtp_precompile(NAME [PROGRAMS] [HEADERS ...] [LIBRARIES ...]): the standard headers and HEADERS,
# for libraries or for PROGRAMS, which are compiled with other flags. They are used by
#   target_precompile_headers(TARGET REUSE_FROM NAME)
# where TARGET gets the same macros from LIBRARIES.
function(mvtp_precompile name)
  cmake_parse_arguments(ARG "PROGRAMS" "" "HEADERS;LIBRARIES" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "// Only the headers count.\n")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE mvtp::options ${ARG_LIBRARIES})
  if(ARG_PROGRAMS)
    set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(${name} PRIVATE ${CMAKE_CXX_COMPILE_OPTIONS_PIE})
  endif()
  target_precompile_headers(${name} PRIVATE ${standard_headers} ${ARG_HEADERS})
endfunction()
