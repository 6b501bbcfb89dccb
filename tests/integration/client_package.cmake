# Installs the client package to a temporary prefix, builds the documented examples against it and lets them exchange messages
# with a process that stands for the services.
add_executable(client_package_services ${CMAKE_CURRENT_LIST_DIR}/client_package_services.cpp)
target_link_libraries(client_package_services PRIVATE sealwatch_transport sealwatch_flags)
add_test(NAME client_package
  COMMAND ${CMAKE_CURRENT_LIST_DIR}/client_package.sh ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}
          $<TARGET_FILE:client_package_services>)
set_tests_properties(client_package PROPERTIES TIMEOUT 180 LABELS integration)
