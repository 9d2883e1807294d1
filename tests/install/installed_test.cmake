# Installs into a folder of its own, as a user would; builds the examples against what is there, and
# runs them and the program. Nothing of it may need the build tree or the source.
#   cmake -DBUILD_DIR=... -DSOURCE_DIR=... -DWORK_DIR=... -DCXX=... -DEIGEN=... -P installed_test.cmake
cmake_policy(VERSION 3.25)
set(prefix ${WORK_DIR}/prefix)
file(REMOVE_RECURSE ${WORK_DIR})

# Runs a command in WORK_DIR; its output must match.
function(expect_output regex)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK_DIR}
    OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
  if(NOT result EQUAL 0 OR NOT output MATCHES "${regex}")
    message(FATAL_ERROR "${ARGN}\nended with ${result} and said\n${output}\nnot ${regex}")
  endif()
endfunction()

file(MAKE_DIRECTORY ${WORK_DIR})
expect_output("mvtp" ${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${prefix})

# The library.
expect_output("" ${CMAKE_COMMAND} -S ${SOURCE_DIR}/docs/examples -B ${WORK_DIR}/examples
  -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_CXX_FLAGS=-Wall\ -Werror)
expect_output("" ${CMAKE_COMMAND} --build ${WORK_DIR}/examples)
expect_output("solved: [0-9]+ steps, 0 violations.*left ends at x = 35.0 m, y = 10.0 m"
  ${WORK_DIR}/examples/solve)
expect_output("finished after [0-9.]+ s; a came within 11.0 m of b" ${WORK_DIR}/examples/controller)

# The public headers and those that they need are all there.
include(${SOURCE_DIR}/cmake/PublicHeaders.cmake)
while(public_headers)
  list(POP_FRONT public_headers name path)
  file(APPEND ${WORK_DIR}/headers.cpp "#include <mvtp/${name}>\n")
endwhile()
expect_output("" ${CXX} -std=c++20 -fsyntax-only -I ${prefix}/include -isystem ${EIGEN}
  ${WORK_DIR}/headers.cpp)

# The programs.
expect_output("^mvtp 1\\." ${prefix}/bin/mvtp --version)
if(WITH_SUMO)  # exit code 1: at that time not everybody has arrived
  expect_output("" sh -c "$1 coordinate -c $2 --end 60 --output-dir run --quiet || [ $? = 1 ]" sh
    ${prefix}/bin/mvtp ${SOURCE_DIR}/scenarios/crossroads/crossroads.sumocfg)
  file(READ ${WORK_DIR}/run/summary.json summary)
  string(JSON completed GET "${summary}" completed)
  if(completed LESS 1)
    message(FATAL_ERROR "nobody arrived: ${summary}")
  endif()
endif()

# The Python package, with the programs beside it.
if(PYTHON)
  set(import ${CMAKE_COMMAND} -E env PYTHONPATH=${prefix}/lib/python3/dist-packages ${PYTHON} -B)
  expect_output("finds 0 violations" ${import} ${SOURCE_DIR}/docs/examples/python/solve.py)
  expect_output("^${prefix}/bin/mvtp" ${import} -c
    "print(__import__('mvtp._program', fromlist=['_program'])._program())")
endif()

# No file points back at the tree that it was built in.
file(GLOB_RECURSE installed ${prefix}/lib/cmake/* ${prefix}/include/* ${prefix}/share/*)
foreach(file IN LISTS installed)
  file(STRINGS ${file} lines REGEX "${SOURCE_DIR}|${BUILD_DIR}")
  if(lines)
    message(FATAL_ERROR "${file} names the build tree: ${lines}")
  endif()
endforeach()
file(GLOB_RECURSE modules ${prefix}/lib/python3/*.so)
foreach(program IN ITEMS ${prefix}/bin/mvtp ${prefix}/libexec/mvtp/mvtp-sumo ${modules})
  if(EXISTS ${program})
    execute_process(COMMAND readelf -d ${program} OUTPUT_VARIABLE dynamic)
    if(dynamic MATCHES "RPATH|RUNPATH")
      message(FATAL_ERROR "${program} has a path to libraries of its own")
    endif()
  endif()
endforeach()

# The version is the same wherever it stands.
execute_process(COMMAND ${prefix}/bin/mvtp --version OUTPUT_VARIABLE version)
string(REGEX MATCH "[0-9]+\\.[0-9]+\\.[0-9]+" version "${version}")
file(READ ${SOURCE_DIR}/CITATION.cff citation)
if(NOT citation MATCHES "version: ${version}\n")
  message(FATAL_ERROR "CITATION.cff is not that of version ${version}")
endif()
