# Builds the Debian packages, looks into them and runs what they install.
add_test(NAME package
  COMMAND ${CMAKE_CURRENT_LIST_DIR}/package.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR})
set_tests_properties(package PROPERTIES TIMEOUT 600 LABELS integration)
