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
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_library(normalshop_compiler INTERFACE)
add_library(normalshop::compiler ALIAS normalshop_compiler)
target_compile_options(
  normalshop_compiler INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast
                                -Werror -ffp-contract=off -fno-math-errno
                                # GCC 12 sees overlaps in std::string's operator+ (GCC bug 105651).
                                $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)

if(NORMALSHOP_SANITIZE)
  target_compile_options(normalshop_compiler INTERFACE -fsanitize=address,undefined
                                                       -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(normalshop_compiler INTERFACE -fsanitize=address,undefined)
endif()

if(NORMALSHOP_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "The fuzzers need clang: cmake --preset sanitize")
  endif()
  # Coverage in every target, so that the fuzzers see into the floors.
  target_compile_options(normalshop_compiler INTERFACE -fsanitize=fuzzer-no-link)
  target_link_options(normalshop_compiler INTERFACE -fsanitize=fuzzer-no-link)
endif()
