# Tests of the product as it is shipped, which the sanitizers cannot run or need not run again.
find_package(Python3 3.10 REQUIRED COMPONENTS Interpreter)
find_program(MKDOCS mkdocs REQUIRED)
set(tests ${CMAKE_CURRENT_SOURCE_DIR})
set(work ${CMAKE_CURRENT_BINARY_DIR})

# What cmake --install leaves, used from outside. Programs of the sanitizers would need their runtime.
add_test(NAME installed
  COMMAND ${CMAKE_COMMAND} -D BUILD_DIR=${PROJECT_BINARY_DIR} -D SOURCE_DIR=${PROJECT_SOURCE_DIR}
    -D WORK_DIR=${work}/installed -D WITH_SUMO=${MVTP_WITH_SUMO}
    -D PYTHON=$<$<BOOL:${MVTP_BUILD_PYTHON}>:${Python3_EXECUTABLE}>
    -D CXX=${CMAKE_CXX_COMPILER}
    "-D EIGEN=$<TARGET_PROPERTY:Eigen3::Eigen,INTERFACE_INCLUDE_DIRECTORIES>"
    -P ${tests}/install/installed_test.cmake)
set_tests_properties(installed PROPERTIES TIMEOUT 300)

# Docs and words.
add_test(NAME vocabulary
  COMMAND ${Python3_EXECUTABLE} ${tests}/vocabulary/vocabulary_test.py ${PROJECT_SOURCE_DIR})
add_test(NAME sizes
  COMMAND ${Python3_EXECUTABLE} ${tests}/sizes/sizes_test.py ${PROJECT_SOURCE_DIR})
add_test(NAME docs.site
  COMMAND ${Python3_EXECUTABLE} ${tests}/docs/site_test.py ${PROJECT_SOURCE_DIR}
    ${PROJECT_BINARY_DIR}/tools/manual/markdown/commands.md ${work}/docs/site)

if(MVTP_WITH_SUMO)
  add_test(NAME docs.commands
    COMMAND ${Python3_EXECUTABLE} ${tests}/docs/commands_test.py ${PROJECT_SOURCE_DIR}
      $<TARGET_FILE_DIR:mvtp> ${work}/docs/commands)
  # The table of results.
  add_test(NAME results
    COMMAND ${Python3_EXECUTABLE} ${tests}/results/results_test.py ${PROJECT_SOURCE_DIR}
      $<TARGET_FILE:mvtp> ${work}/results)
  set_tests_properties(docs.commands results PROPERTIES TIMEOUT 600)

  # Several machines at once. The one with Slurm skips itself where Slurm is not installed.
  foreach(cluster parallel slurm)
    set(folder ${work}/cluster-${cluster})
    add_test(NAME cluster.${cluster}
      COMMAND sh -c "rm -rf '${folder}' && mkdir '${folder}' && exec bash \
'${tests}/tools/cluster/${cluster}_test.sh'")
    set_tests_properties(cluster.${cluster} PROPERTIES TIMEOUT 300 SKIP_RETURN_CODE 77
      ENVIRONMENT "MVTP=$<TARGET_FILE:mvtp>;SOURCE=${PROJECT_SOURCE_DIR};WORK=${folder}")
  endforeach()

  # Each run of the network suite has a limit to its address space, which the sanitizer exceeds.
  add_test(NAME networks.short
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tools/networks/suite.py --short --again
      --mvtp $<TARGET_FILE:mvtp> --timeout 120 -o ${work}/networks)
  set_tests_properties(networks.short PROPERTIES LABELS networks TIMEOUT 600)
endif()

if(MVTP_BUILD_PYTHON)
  if(MVTP_WITH_SUMO)
    set_tests_properties(docs.commands PROPERTIES
      ENVIRONMENT "MVTP_PYTHON=${Python3_EXECUTABLE};MVTP_PYTHON_TREE=${MVTP_PYTHON_TREE}")
  endif()
  add_subdirectory(tools/python)
endif()
