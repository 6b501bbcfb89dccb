# Installs the client package to a temporary prefix, builds the documented example against it and lets it print an advisory
# that another process publishes.
add_executable(client_package_publisher ${CMAKE_CURRENT_LIST_DIR}/client_package_publisher.cpp)
target_link_libraries(client_package_publisher PRIVATE sealwatch_transport sealwatch_flags)
add_test(NAME client_package
  COMMAND ${CMAKE_CURRENT_LIST_DIR}/client_package.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
          $<TARGET_FILE:client_package_publisher>)
set_tests_properties(client_package PROPERTIES TIMEOUT 180 LABELS integration)
