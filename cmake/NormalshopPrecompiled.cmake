# Precompiled headers: what nearly every file includes, compiled once for each kind of target instead of
# once a file. Files include what they use all the same; NORMALSHOP_PCH=OFF shows whether they do.

# normalshop_precompile(KIND [HEADERS ...] [LIBRARIES ...]): the headers of all floors, programs or
# tests. HEADERS come on top of the common ones, LIBRARIES say how these are compiled.
function(normalshop_precompile kind)
  if(NOT NORMALSHOP_PCH)
    return()
  endif()
  cmake_parse_arguments(PRECOMPILE "" "" "HEADERS;LIBRARIES" ${ARGN})
  set(target normalshop_${kind}_headers)
  file(WRITE ${PROJECT_BINARY_DIR}/${target}.cpp "")
  add_library(${target} OBJECT ${PROJECT_BINARY_DIR}/${target}.cpp)
  target_link_libraries(${target} PRIVATE Eigen3::Eigen ${PRECOMPILE_LIBRARIES}
                                          normalshop::${kind}_compiler)
  if(NOT kind STREQUAL "floor")
    target_compile_options(${target} PRIVATE -fPIE) # as CMake compiles programs; g++ insists
  endif()
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Equal headers give equal bytes, so that ccache finds what was compiled with them.
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
  target_precompile_headers(
    ${target}
    PRIVATE
    <algorithm>
    <array>
    <cmath>
    <cstdint>
    <cstdio>
    <cstring>
    <filesystem>
    <functional>
    <limits>
    <memory>
    <optional>
    <span>
    <string>
    <string_view>
    <tuple>
    <utility>
    <vector>
    <Eigen/Core>
    <Eigen/Geometry>
    ${PRECOMPILE_HEADERS})
endfunction()

# normalshop_precompiled(TARGET KIND): lets a target start from the headers of its kind.
function(normalshop_precompiled target kind)
  if(NORMALSHOP_PCH)
    target_precompile_headers(${target} REUSE_FROM normalshop_${kind}_headers)
    # GCC 12 sees overflows in std::string's operator+ (GCC bug 105651) and, with precompiled headers,
    # forgets that they stand in a system header. Clang and the sanitizers look for the true ones.
    target_compile_options(
      ${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds;-Wno-stringop-overflow>)
  endif()
endfunction()
