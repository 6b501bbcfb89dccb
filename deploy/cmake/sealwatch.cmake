# Helpers by which each folder declares what it builds.
#
#   sealwatch_library(sealwatch_core SOURCES a.cpp LINK tl::expected PRIVATE_LINK Ceres::ceres)
#   sealwatch_library(sealwatch_cli WORDS ...)   handles text, or decides once a test: optimised little, compiled fast
#   sealwatch_executable(sealwatch-state-detection SOURCES main.cpp LINK sealwatch_runtime)
#   sealwatch_test(core_test SOURCES core_test.cpp LINK sealwatch_core LABELS unit)
#   sealwatch_waits(campaign_kills)
#
# Tests start in the order of COST: by default their TIMEOUT in seconds, so that what may take long starts first.

add_library(sealwatch_flags INTERFACE)
target_compile_options(sealwatch_flags INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror>)
# GCC looks for garbage of its own only above 512 MB: a tenth less processor time, a fifth more memory (1.1 GB at most).
target_compile_options(sealwatch_flags INTERFACE
  $<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288>)
# 0.45 % more instructions in an estimate (estimation_benchmark under callgrind). Debian's compiler makes position-independent
# executables by itself; the sanitizers have checks of their own.
if(SEALWATCH_HARDENED AND NOT SEALWATCH_SANITIZE)
  set(optimised $<CONFIG:Release,RelWithDebInfo,MinSizeRel>)
  target_compile_options(sealwatch_flags INTERFACE
    $<${optimised}:-fstack-protector-strong$<SEMICOLON>-fstack-clash-protection>)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64)
    target_compile_options(sealwatch_flags INTERFACE $<${optimised}:-fcf-protection>)
  endif()
  target_link_options(sealwatch_flags INTERFACE $<${optimised}:-Wl,-z,relro,-z,now,-z,noexecstack>)
  # An index beyond a vector's end ends the program, too, where that was measured to cost under 3 % of the instructions
  # (docs/records/performance.tsv). In the model it costs 15 %: its loops index short vectors.
  set(checked $<BOOL:$<TARGET_PROPERTY:SEALWATCH_CHECKED>>)
  target_compile_definitions(sealwatch_flags INTERFACE $<$<AND:${optimised},${checked}>:_GLIBCXX_ASSERTIONS>)
endif()
if(SEALWATCH_SANITIZE)
  set(instrumented $<NOT:$<BOOL:$<TARGET_PROPERTY:SEALWATCH_NOT_INSTRUMENTED>>>)
  target_compile_options(sealwatch_flags INTERFACE
    $<${instrumented}:-fsanitize=${SEALWATCH_SANITIZE}$<SEMICOLON>-fno-sanitize-recover=all>
    -fno-omit-frame-pointer)
  target_link_options(sealwatch_flags INTERFACE -fsanitize=${SEALWATCH_SANITIZE})
endif()

include(${CMAKE_CURRENT_LIST_DIR}/unity.cmake)

function(sealwatch_library name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "WORDS" "" "SOURCES;LINK;PRIVATE_LINK")
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${name} PUBLIC ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK} $<BUILD_INTERFACE:sealwatch_flags>)
  if(ARG_WORDS)
    sealwatch_words(${name})
  endif()
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "/common/(core|dense|estimation|signal|text)$")
    set_target_properties(${name} PROPERTIES SEALWATCH_CHECKED ON)
  endif()
  # The engine computes alone, in no test of how processes meet: without it such a build takes a quarter of the time.
  if(NOT SEALWATCH_SANITIZE_ENGINE AND CMAKE_CURRENT_SOURCE_DIR MATCHES
      "/common/(equations|estimation|fmi|forecast|mismatch|model|report|signal|trace)$|/(cli|verification)$")
    set_target_properties(${name} PROPERTIES SEALWATCH_NOT_INSTRUMENTED ON)
  endif()
  sealwatch_unity(${name})
endfunction()

# A third of the time that compiling takes is the optimiser's, which words do not need.
function(sealwatch_words name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

function(sealwatch_executable name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LINK")
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} sealwatch_flags)
  sealwatch_words(${name})  # main() alone
  sealwatch_unity(${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

# Tests find the repository and the public recordings through these definitions. SHARDS n: the program's tests are dealt
# out to n tests of ctest, name_1 to name_n, which run side by side.
function(sealwatch_test name)
  if(NOT SEALWATCH_TESTS)
    return()
  endif()
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "TIMEOUT;SHARDS" "SOURCES;LINK;LABELS")
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gmock GTest::gtest_main sealwatch_flags)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
  target_compile_definitions(${name} PRIVATE
    SEALWATCH_SOURCE_DIR="${PROJECT_SOURCE_DIR}" SEALWATCH_BINARY_DIR="${PROJECT_BINARY_DIR}"
    SEALWATCH_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  sealwatch_words(${name})  # what takes time when a test runs is the libraries
  sealwatch_unity(${name})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(SEALWATCH_SANITIZE)
    math(EXPR ARG_TIMEOUT "10 * ${ARG_TIMEOUT}")
  endif()
  if(NOT ARG_SHARDS)
    add_test(NAME ${name} COMMAND ${name})
    set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
    return()
  endif()
  foreach(shard RANGE 1 ${ARG_SHARDS})
    math(EXPR index "${shard} - 1")
    add_test(NAME ${name}_${shard} COMMAND ${name})
    set_tests_properties(${name}_${shard} PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${ARG_TIMEOUT} LABELS "${ARG_LABELS}"
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${index}")
  endforeach()
endfunction()

# Tests that wait for processes more than they compute: they start first, two at a time, beside those that compute
# (tests/run.sh runs two more tests than there are cores). More at once would strain the services' heartbeats.
function(sealwatch_waits)
  foreach(test ${ARGN})
    get_property(waiting GLOBAL PROPERTY SEALWATCH_WAITING)
    math(EXPR lane "(0${waiting} + 1) % 2")
    set_property(GLOBAL PROPERTY SEALWATCH_WAITING ${lane})
    set_tests_properties(${test} PROPERTIES COST 3000 RESOURCE_LOCK waiting_${lane})
  endforeach()
endfunction()
