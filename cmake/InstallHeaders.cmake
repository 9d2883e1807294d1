# Installs the public headers as <mvtp/NAME> and those that they need below <mvtp/...>; run by
# cmake --install with source_dir, headers_dir and include_dir.
cmake_policy(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/PublicHeaders.cmake)

file(REMOVE_RECURSE ${headers_dir})
set(wanted)
while(public_headers)
  list(POP_FRONT public_headers name path)
  file(WRITE ${headers_dir}/mvtp/${name} "#pragma once\n\n#include <mvtp/${path}>\n")
  list(APPEND wanted ${path})
endwhile()

# Our includes name paths from the root of the project; there they begin with mvtp/.
set(seen)
while(wanted)
  list(POP_FRONT wanted path)
  if(path IN_LIST seen)
    continue()
  endif()
  list(APPEND seen ${path})
  file(READ ${source_dir}/${path} text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "#include \"(.*)\"" "\\1" needed "${include}")
    list(APPEND wanted ${needed})
  endforeach()
  string(REGEX REPLACE "#include \"([^\"]+)\"" "#include <mvtp/\\1>" text "${text}")
  file(WRITE ${headers_dir}/mvtp/${path} "${text}")
endwhile()

file(INSTALL ${headers_dir}/mvtp DESTINATION ${CMAKE_INSTALL_PREFIX}/${include_dir})
