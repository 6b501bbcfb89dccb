# Run by `cmake --install` and CPack. An installation for the whole machine (/usr, /usr/local) keeps its configuration in /etc,
# where `sealwatch` looks for it; any other prefix keeps everything beneath itself.
cmake_path(ABSOLUTE_PATH CMAKE_INSTALL_PREFIX NORMALIZE OUTPUT_VARIABLE prefix)
if(prefix MATCHES "^/usr(/local)?/?$")
  set(SEALWATCH_CONFIG /etc/sealwatch)
else()
  set(SEALWATCH_CONFIG ${prefix}/etc/sealwatch)
endif()

set(SEALWATCH_BINDIR ${prefix}/${bindir})
set(units ${source_directory}/deploy/systemd)
configure_file(${units}/sealwatch@.service.in ${binary_directory}/sealwatch@.service @ONLY)
file(INSTALL ${binary_directory}/sealwatch@.service ${units}/sealwatch.target DESTINATION ${prefix}/lib/systemd/system)
file(INSTALL ${units}/clock.conf DESTINATION ${prefix}/lib/systemd/system/sealwatch@data-acquisition.service.d)
file(INSTALL ${units}/sealwatch.sysusers DESTINATION ${prefix}/lib/sysusers.d RENAME sealwatch.conf)

# A configuration that somebody may have changed is left alone.
file(GLOB_RECURSE files RELATIVE ${source_directory}/config ${source_directory}/config/*.yaml)
foreach(file ${files})
  cmake_path(GET file PARENT_PATH folder)
  if(NOT EXISTS $ENV{DESTDIR}${SEALWATCH_CONFIG}/${file})
    file(INSTALL ${source_directory}/config/${file} DESTINATION ${SEALWATCH_CONFIG}/${folder})
  endif()
endforeach()
