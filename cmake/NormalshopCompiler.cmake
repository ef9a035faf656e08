# Compiler settings shared by every target: C++20, warnings as errors, and floating point that gives
# the same bits on every machine (no contraction into fused multiply-add).
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # ccache asks for this leave before it keeps what was compiled with precompiled headers.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
                                  ${CCACHE_PROGRAM})
endif()

add_library(normalshop_compiler INTERFACE)
add_library(normalshop::compiler ALIAS normalshop_compiler)
target_compile_options(
  normalshop_compiler INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
                                -Wzero-as-null-pointer-constant
                                -Werror -ffp-contract=off -fno-math-errno
                                # GCC 12 sees overlaps in std::string's operator+ (GCC bug 105651).
                                $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)

# Floors that take bytes from outside have the property NORMALSHOP_READS. They are checked in full and
# show the fuzzers which branches these reach.
set(reads $<BOOL:$<TARGET_PROPERTY:NORMALSHOP_READS>>)
if(NORMALSHOP_SANITIZE)
  target_compile_options(normalshop_compiler INTERFACE -fsanitize=address,undefined
                                                       -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Elsewhere these are a third of the compile time: ASan sees what is null or too small, classes are not
    # cast down, and kernels load from any address.
    target_compile_options(normalshop_compiler
                           INTERFACE $<$<NOT:${reads}>:-fno-sanitize=null,alignment,object-size,vptr>)
  endif()
  target_link_options(normalshop_compiler INTERFACE -fsanitize=address,undefined)
endif()

if(NORMALSHOP_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "The fuzzers need clang: cmake --preset sanitize")
  endif()
  # What of -fsanitize=fuzzer-no-link matters, in words that precompiled headers need not share.
  target_compile_options(
    normalshop_compiler
    INTERFACE $<${reads}:-fsanitize-coverage=inline-8bit-counters,indirect-calls,trace-cmp,pc-table>)
endif()

# The floors do the work. The tests around them take longer to compile than to run, most of all with
# sanitizers, so they are optimised less.
foreach(kind floor program test)
  add_library(normalshop_${kind}_compiler INTERFACE)
  add_library(normalshop::${kind}_compiler ALIAS normalshop_${kind}_compiler)
  target_link_libraries(normalshop_${kind}_compiler INTERFACE normalshop::compiler)
endforeach()
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  # Highway's emulated target takes two thirds of a kernel's compile time, for processors before 2011.
  target_compile_definitions(normalshop_compiler INTERFACE HWY_BASELINE_TARGETS=HWY_SSSE3)
endif()
if(NORMALSHOP_SANITIZE)
  target_compile_options(normalshop_test_compiler INTERFACE -O0)
else()
  target_compile_options(normalshop_test_compiler INTERFACE $<$<CONFIG:Release>:-O1>)
endif()
