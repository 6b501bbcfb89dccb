# Installs what other people's programs build against (component "client"): static libraries, headers, IDL files and the
# CMake package that finds them.
include(CMakePackageConfigHelpers)

set(package_directory ${CMAKE_INSTALL_LIBDIR}/cmake/sealwatch)
set(SEALWATCH_IDL_DIR ${CMAKE_INSTALL_DATADIR}/sealwatch/idl)

set_target_properties(sealwatch_client PROPERTIES EXPORT_NAME client)
set_target_properties(sealwatch_transport PROPERTIES EXPORT_NAME transport)
set_target_properties(sealwatch_topics PROPERTIES EXPORT_NAME topics)
set_target_properties(sealwatch_core PROPERTIES EXPORT_NAME core)
set_target_properties(sealwatch_text PROPERTIES EXPORT_NAME text)
install(TARGETS sealwatch_client sealwatch_transport sealwatch_topics sealwatch_core sealwatch_text EXPORT sealwatchTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client)
install(EXPORT sealwatchTargets NAMESPACE sealwatch:: DESTINATION ${package_directory} COMPONENT client)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/sealwatch/core ${PROJECT_SOURCE_DIR}/include/sealwatch/message
                  ${PROJECT_SOURCE_DIR}/include/sealwatch/client
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sealwatch COMPONENT client FILES_MATCHING PATTERN *.hpp)
# What topics carry as it is.
install(FILES ${PROJECT_SOURCE_DIR}/include/sealwatch/estimation/fit_report.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sealwatch/estimation COMPONENT client)
install(FILES ${PROJECT_SOURCE_DIR}/include/sealwatch/forecast/forecast.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sealwatch/forecast COMPONENT client)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/idl/ DESTINATION ${SEALWATCH_IDL_DIR} COMPONENT client
  FILES_MATCHING PATTERN *.idl)

configure_package_config_file(${PROJECT_SOURCE_DIR}/deploy/cmake/sealwatchConfig.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/sealwatchConfig.cmake
  INSTALL_DESTINATION ${package_directory} PATH_VARS SEALWATCH_IDL_DIR)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/sealwatchConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sealwatchConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/sealwatchConfigVersion.cmake
  DESTINATION ${package_directory} COMPONENT client)
