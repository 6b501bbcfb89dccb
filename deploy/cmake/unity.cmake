# Compiles several sources of a target in one go, as headers and templates then cost once a batch and not once a file.
#
#   sealwatch_unity(TARGET)    after its sources are known; does nothing without -DSEALWATCH_UNITY=ON
#
# Names that a file keeps to itself may be another file's too: such files go into different batches, and a file whose
# name is one of its folder's headers' stays alone, so nobody has to think of it. What a file calls its own is read from
# its text, which clang-format keeps in one shape: what stands at the beginning of a line, and every constant kLikeThis.
# More names than there are only make more batches.
set(SEALWATCH_UNITY_BATCH 8)  # sources: 16 take as much processor time in all, and 1.7 GB of memory for a batch

# The last words of `matches`, each once.
function(sealwatch_last_words matches result)
  set(names "")
  foreach(match IN LISTS matches)
    string(REGEX REPLACE "[( {=]+$" "" match "${match}")
    string(REGEX MATCH "[A-Za-z0-9_]+$" name "${match}")
    list(APPEND names ${name})
  endforeach()
  list(REMOVE_DUPLICATES names)
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

# Names that `file` defines: functions; types and constants; what it says `using` of.
function(sealwatch_own_names file functions others aliases)
  file(READ ${file} text)
  string(REGEX REPLACE "[][;\\]" " " text "\n${text}")  # what CMake's lists would trip over
  string(REGEX MATCHALL "\n[A-Za-z][A-Za-z0-9_:<>,*& ]*[ *&][A-Za-z0-9_]+\\(" found "${text}")
  sealwatch_last_words("${found}" found)
  set(${functions} "${found}" PARENT_SCOPE)
  string(REGEX MATCHALL "\n(struct|class|enum class|enum|union) [A-Za-z0-9_]+[ {]" types "${text}")
  string(REGEX MATCHALL "const(expr)? [A-Za-z0-9_:<>,*& ]*k[A-Z][A-Za-z0-9_]*[ {=]" constants "${text}")
  sealwatch_last_words("${types};${constants}" found)
  set(${others} "${found}" PARENT_SCOPE)
  string(REGEX MATCHALL "\nusing [A-Za-z0-9_:]+ " found "${text}")
  sealwatch_last_words("${found}" found)
  set(${aliases} "${found}" PARENT_SCOPE)
endfunction()

function(sealwatch_header_names folder result)
  file(GLOB headers ${folder}/*.hpp)
  set(names "")
  foreach(header IN LISTS headers)
    sealwatch_own_names(${header} functions others aliases)
    list(APPEND names ${others})
  endforeach()
  set(${result} "${names}" PARENT_SCOPE)
endfunction()

# Whether any name stands in both lists.
function(sealwatch_shares one other result)
  list(REMOVE_DUPLICATES one)
  list(REMOVE_DUPLICATES other)
  set(both ${one} ${other})
  list(LENGTH both apart)
  list(REMOVE_DUPLICATES both)
  list(LENGTH both together)
  if(together EQUAL apart)
    set(${result} FALSE PARENT_SCOPE)
  else()
    set(${result} TRUE PARENT_SCOPE)
  endif()
endfunction()

# Each file goes into the first batch that has room and none of its names.
function(sealwatch_unity target)
  if(NOT SEALWATCH_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  sealwatch_header_names(${folder} of_headers)
  set(batches 0)
  foreach(source IN LISTS sources)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${folder} OUTPUT_VARIABLE file)
    get_source_file_property(made ${file} DIRECTORY ${folder} GENERATED)
    if(NOT source MATCHES "\\.cpp$" OR made)  # by the build: its names are not known at first, its text changes
      continue()
    endif()
    set_property(DIRECTORY ${folder} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    sealwatch_own_names(${file} functions others aliases)
    sealwatch_shares("${others};${aliases}" "${of_headers}" alone)
    if(alone)
      set_property(SOURCE ${source} DIRECTORY ${folder} PROPERTY SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    set(place "")
    foreach(batch RANGE ${batches})
      sealwatch_shares("${functions};${others}" "${names_${batch}}" taken)
      list(LENGTH files_${batch} size)
      if(size LESS SEALWATCH_UNITY_BATCH AND NOT taken)
        set(place ${batch})
        break()
      endif()
    endforeach()
    if(place STREQUAL "")
      math(EXPR batches "${batches} + 1")
      set(place ${batches})
    endif()
    list(APPEND files_${place} ${source})
    list(APPEND names_${place} ${functions} ${others})
    set_property(SOURCE ${source} DIRECTORY ${folder} PROPERTY UNITY_GROUP "batch_${place}")
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()
