# The library for other projects: find_package(mvtp) gives mvtp::planner and mvtp::coordinator.
include(CMakePackageConfigHelpers)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mvtp)
foreach(library IN ITEMS planner coordinator)
  set_target_properties(mvtp_${library} PROPERTIES EXPORT_NAME ${library})
  target_compile_features(mvtp_${library} PUBLIC cxx_std_20)
  target_include_directories(mvtp_${library}
    INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
endforeach()
install(TARGETS mvtp_planner mvtp_coordinator EXPORT mvtpTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(EXPORT mvtpTargets NAMESPACE mvtp:: DESTINATION ${config_dir} COMPONENT development)

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/mvtpConfig.cmake.in
  ${PROJECT_BINARY_DIR}/mvtpConfig.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mvtpConfigVersion.cmake
  COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mvtpConfig.cmake ${PROJECT_BINARY_DIR}/mvtpConfigVersion.cmake
  DESTINATION ${config_dir} COMPONENT development)

install(CODE "set(source_dir \"${PROJECT_SOURCE_DIR}\")
set(headers_dir \"${PROJECT_BINARY_DIR}/headers\")
set(include_dir \"${CMAKE_INSTALL_INCLUDEDIR}\")" COMPONENT development)
install(SCRIPT cmake/InstallHeaders.cmake COMPONENT development)
