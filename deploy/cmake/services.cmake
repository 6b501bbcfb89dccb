# Installs what runs sealwatch (component "services"): programs, systemd units, default configuration, documents. Manual page and
# completion are installed where they are made, services/cli. All programs share a folder: `sealwatch up` looks for the services
# beside itself.
foreach(service data-acquisition data-manipulation state-detection health-assessment prognostic-assessment
                advisory-generation virtual-bench)
  install(TARGETS sealwatch-${service} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT services)
endforeach()
add_subdirectory(systemd)
install(PROGRAMS ${PROJECT_SOURCE_DIR}/deploy/security/make_identities.sh DESTINATION ${CMAKE_INSTALL_DATADIR}/sealwatch/security
  COMPONENT services)
install(FILES ${PROJECT_SOURCE_DIR}/deploy/security/governance.xml.in ${PROJECT_SOURCE_DIR}/deploy/security/cyclonedds.xml.in
  ${PROJECT_SOURCE_DIR}/deploy/systemd/security.conf DESTINATION ${CMAKE_INSTALL_DATADIR}/sealwatch/security COMPONENT services)

set(document_directory ${CMAKE_INSTALL_DATADIR}/doc/sealwatch)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/CHANGELOG.md
  DESTINATION ${document_directory} COMPONENT services)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${document_directory} COMPONENT services
  FILES_MATCHING PATTERN *.md PATTERN examples EXCLUDE)

# The bill of materials is of the programs as they are linked here.
set(programs sealwatch sealwatch-fmu-host)
foreach(service data-acquisition data-manipulation state-detection health-assessment prognostic-assessment
                advisory-generation virtual-bench)
  list(APPEND programs sealwatch-${service})
endforeach()
list(TRANSFORM programs REPLACE "(.+)" "\"$<TARGET_FILE:\\1>\"")
list(JOIN programs " " programs)
install(CODE "execute_process(
    COMMAND \"${PROJECT_SOURCE_DIR}/deploy/sbom.sh\" ${PROJECT_VERSION}
            \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${document_directory}/sbom.spdx.json\" ${programs}
    RESULT_VARIABLE failed)
  if(failed)
    message(WARNING \"no software bill of materials: deploy/sbom.sh says why\")
  endif()" COMPONENT services)
