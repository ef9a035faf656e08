# normalshop_floor(NAME SOURCES ... [FLOORS ...] [PRIVATE_LIBRARIES ...] [READS])
# One floor = one static library normalshop::NAME. FLOORS are the floors below it that its public
# headers use; third-party packages of a floor stay private to its .cpp files. READS: it takes bytes
# from outside.
function(normalshop_floor name)
  cmake_parse_arguments(FLOOR "READS" "" "SOURCES;FLOORS;PRIVATE_LIBRARIES" ${ARGN})
  add_library(normalshop_${name} STATIC ${FLOOR_SOURCES})
  add_library(normalshop::${name} ALIAS normalshop_${name})
  target_include_directories(normalshop_${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  list(TRANSFORM FLOOR_FLOORS PREPEND normalshop::)
  target_link_libraries(
    normalshop_${name}
    PUBLIC ${FLOOR_FLOORS} Eigen3::Eigen
    PRIVATE ${FLOOR_PRIVATE_LIBRARIES} normalshop::floor_compiler)
  normalshop_precompiled(normalshop_${name} floor)
  set_target_properties(normalshop_${name} PROPERTIES NORMALSHOP_READS ${FLOOR_READS})
  normalshop_join(normalshop_${name})
endfunction()

# normalshop_join(TARGET): with NORMALSHOP_UNITY, compiles several sources of a target in one go. Kernels
# for several instruction sets include themselves, so they go alone.
function(normalshop_join target)
  if(NOT NORMALSHOP_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    file(STRINGS ${source} kernels REGEX "foreach_target" LIMIT_COUNT 1)
    if(kernels)
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
endfunction()

# normalshop_floors_first(TARGET): of an inline function that several sources compile, the linker takes the
# first that it meets: with sanitizers let that be an optimised one, from as low a floor as there is.
function(normalshop_floors_first target)
  if(NOT NORMALSHOP_SANITIZE)
    return()
  endif()
  normalshop_floors_under(${target} floors)
  list(TRANSFORM floors REPLACE "(.+)" "$<TARGET_FILE:\\1>")
  target_link_options(${target} PRIVATE "LINKER:--whole-archive" ${floors} "LINKER:--no-whole-archive")
endfunction()

# normalshop_floors_under(TARGET RESULT): our static libraries that a target links, lower floors first.
function(normalshop_floors_under target result)
  set(found)
  get_target_property(libraries ${target} LINK_LIBRARIES)
  foreach(library ${libraries})
    string(REPLACE "normalshop::" "normalshop_" library "${library}")
    if(NOT TARGET ${library} OR NOT library MATCHES "^normalshop_")
      continue()
    endif()
    get_target_property(type ${library} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      normalshop_floors_under(${library} under)
      list(APPEND found ${under} ${library})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES found)
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# normalshop_test(NAME SOURCES ... LIBRARIES ... [LOOPS ...] [SUITES]): one GoogleTest program for a folder
# of tests. LOOPS are those of the sources whose own loops would take minutes under sanitizers without
# optimisation. SUITES: the program takes long to start, so ctest starts it once a suite instead of
# once a test.
function(normalshop_test name)
  cmake_parse_arguments(TEST "SUITES" "" "SOURCES;LIBRARIES;LOOPS" ${ARGN})
  add_executable(test_${name} ${TEST_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(test_${name} PRIVATE NORMALSHOP_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_link_libraries(test_${name} PRIVATE ${TEST_LIBRARIES} GTest::gtest_main normalshop::test_compiler)
  normalshop_precompiled(test_${name} test)
  normalshop_floors_first(test_${name})
  if(NORMALSHOP_SANITIZE AND TEST_LOOPS)
    set_source_files_properties(${TEST_LOOPS} PROPERTIES COMPILE_OPTIONS -O1 SKIP_PRECOMPILE_HEADERS ON)
  endif()
  normalshop_join(test_${name})
  if(TEST_SUITES)
    normalshop_add_suites(test_${name} ${TEST_SOURCES})
  else()
    gtest_discover_tests(test_${name} NO_PRETTY_VALUES DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
  endif()
endfunction()

# normalshop_add_suites(PROGRAM SOURCES ...): each suite of the sources as a test of ctest.
function(normalshop_add_suites program)
  set(suites)
  foreach(source ${ARGN})
    file(STRINGS ${source} lines REGEX "^TEST(_F|_P)?\\(")
    if(lines)
      set_property(
        DIRECTORY
        APPEND
        PROPERTY CMAKE_CONFIGURE_DEPENDS ${source})
    endif()
    list(TRANSFORM lines REPLACE "^TEST(_F|_P)?\\(([^,]*),.*" "\\2")
    list(APPEND suites ${lines})
  endforeach()
  list(REMOVE_DUPLICATES suites)
  set(all_skipped "PASSED  . 0 tests[.]\n(.  SKIPPED .[^\n]*\n)+$")
  foreach(suite ${suites})
    add_test(NAME ${suite} COMMAND ${program} --gtest_filter=${suite}.*:*/${suite}.*)
    set_tests_properties(${suite} PROPERTIES TIMEOUT 900 SKIP_REGULAR_EXPRESSION "${all_skipped}"
                                                FAIL_REGULAR_EXPRESSION "Running 0 tests")
  endforeach()
endfunction()

# normalshop_fuzzer(NAME SOURCES ... LIBRARIES ...): the libFuzzer program fuzz_NAME. Its seeds, if
# any, lie in fuzz/corpus/NAME; `dev check` runs it.
function(normalshop_fuzzer name)
  cmake_parse_arguments(FUZZ "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(fuzz_${name} ${FUZZ_SOURCES})
  target_link_libraries(fuzz_${name} PRIVATE ${FUZZ_LIBRARIES} normalshop::program_compiler)
  normalshop_precompiled(fuzz_${name} program)
  target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
endfunction()
