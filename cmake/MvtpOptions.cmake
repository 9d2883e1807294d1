# What every target of the project is compiled with.
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(MVTP_CCACHE ccache)
if(MVTP_CCACHE)
  # Without these it does not keep what was compiled with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${MVTP_CCACHE})
endif()

# The libraries also go into shared ones: Python modules, plugins.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

add_library(mvtp_options INTERFACE)
add_library(mvtp::options ALIAS mvtp_options)
target_include_directories(mvtp_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_options(mvtp_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  -Wno-missing-field-initializers  # designated initialisers leave the rest to the type
  # Every figure must be the same on every machine: no fused multiply-adds behind our back.
  -ffp-contract=off
  # Position-independent, yet as fast: nobody replaces our functions at load time.
  -fno-semantic-interposition)
if(MVTP_JOIN_SOURCES)
  # In a group the names of one file may hide those of another, which clang minds.
  target_compile_options(mvtp_options INTERFACE $<$<CXX_COMPILER_ID:Clang>:-Wno-shadow>)
endif()
target_link_options(mvtp_options INTERFACE LINKER:-z,relro,-z,now)
if(MVTP_WERROR)
  target_compile_options(mvtp_options INTERFACE -Werror)
endif()
if(MVTP_SANITIZE)
  target_compile_options(mvtp_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(mvtp_options INTERFACE -fsanitize=address,undefined)
  # What the standard library asks of its callers: an optional that has a value, an index in bounds.
  target_compile_definitions(mvtp_options INTERFACE _GLIBCXX_ASSERTIONS)
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    # A third less to compile: the code of others is not what is tested.
    target_compile_options(mvtp_options INTERFACE
      -fsanitize-ignorelist=${CMAKE_CURRENT_LIST_DIR}/not_sanitized.txt)
  endif()
endif()
