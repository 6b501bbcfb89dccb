# Debian packages, made by `cpack` in the build directory: sealwatch (component "services") and sealwatch-dev ("client").
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME sealwatch)
set(CPACK_PACKAGE_CONTACT "sealwatch maintainers <maintainers@users.noreply.h-seed-d5d17d71.example>")
set(CPACK_COMPONENTS_ALL services client)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(debian ${PROJECT_SOURCE_DIR}/deploy/debian)
install(FILES ${debian}/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sealwatch COMPONENT services)
install(FILES ${debian}/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/sealwatch-dev COMPONENT client)

# Debian's own changelog, compressed as its policy asks; CHANGELOG.md is for people.
add_custom_command(OUTPUT changelog.gz COMMAND gzip -9nc ${debian}/changelog > changelog.gz
  DEPENDS ${debian}/changelog VERBATIM)
add_custom_target(sealwatch_changelog ALL DEPENDS changelog.gz)
foreach(package sealwatch/services sealwatch-dev/client)
  get_filename_component(component ${package} NAME)
  get_filename_component(name ${package} DIRECTORY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name}
          COMPONENT ${component})
endforeach()

# Every file below /etc is a conffile: an upgrade asks before it replaces one that was changed.
file(GLOB_RECURSE files RELATIVE ${PROJECT_SOURCE_DIR}/config CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/*.yaml)
list(TRANSFORM files PREPEND /etc/sealwatch/)
list(JOIN files "\n" conffiles)
file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/conffiles CONTENT "${conffiles}\n" @ONLY)

set(CPACK_DEBIAN_SERVICES_PACKAGE_NAME sealwatch)
set(CPACK_DEBIAN_SERVICES_PACKAGE_SECTION science)
set(CPACK_COMPONENT_SERVICES_DESCRIPTION "From the monthly partial stroke test of an actuator sealwatch estimates
the leakage resistance of its piston seal, forecasts the remaining useful
life and says when to intervene, and why. Six services, one per layer of
ISO 13374, exchange Cyclone DDS topics.")
set(CPACK_DEBIAN_SERVICES_PACKAGE_SHLIBDEPS ON)
# SOCI loads its backends at run time, so no program is linked to them. The default journals are SQLite files.
set(CPACK_DEBIAN_SERVICES_PACKAGE_DEPENDS libsoci-sqlite3-4.0)
set(CPACK_DEBIAN_SERVICES_PACKAGE_RECOMMENDS "libsoci-postgresql4.0, openssl")
set(CPACK_DEBIAN_SERVICES_PACKAGE_CONTROL_EXTRA
  ${CMAKE_CURRENT_BINARY_DIR}/conffiles ${debian}/postinst ${debian}/prerm ${debian}/postrm)

set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME sealwatch-dev)
set(CPACK_DEBIAN_CLIENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_CLIENT_DESCRIPTION "Development files: topics in IDL, and a subscriber library for programs that
receive sealwatch's advisories, by find_package(sealwatch).")
set(CPACK_DEBIAN_CLIENT_PACKAGE_DEPENDS "cyclonedds-dev, libexpected-dev, libfmt-dev")
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS "sealwatch, cmake")
include(CPack)
