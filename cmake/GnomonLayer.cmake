# gnomon_layer(NAME [HOSTS HEADER...]): applies the common settings to the target gnomon_NAME, which must exist, and adds its alias
# gnomon::NAME. HOSTS: the headers for hosts. They alone are installed, and include no others; tests/package/use_package compiles them.
#
# The only include folder of a layer is its own. It can include headers of another layer only if it links that layer. For
# example, `#include "draw_pass.hh"` in source/gpu does not compile. This enforces the dependencies in doc/architecture.md.
function(gnomon_layer NAME)
  set(TARGET gnomon_${NAME})
  add_library(gnomon::${NAME} ALIAS ${TARGET})
  set_target_properties(${TARGET} PROPERTIES EXPORT_NAME ${NAME})
  gnomon_compile_settings(${TARGET})
  gnomon_reuse_pch(${TARGET} gnomon_pch)
  gnomon_export_symbols(${TARGET})
  target_include_directories(${TARGET} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}>)
  cmake_parse_arguments(PARSE_ARGV 1 LAYER "" "" HOSTS)
  if(LAYER_HOSTS)
    target_sources(${TARGET} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR} FILES ${LAYER_HOSTS})
  endif()
  # all_verify_interface_header_sets checks that each header compiles alone. The exported target may have installed headers only.
  file(GLOB HEADERS CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.hh)
  add_library(${TARGET}_headers INTERFACE)
  set_target_properties(${TARGET}_headers PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(${TARGET}_headers INTERFACE FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR} FILES ${HEADERS})
  target_link_libraries(${TARGET}_headers INTERFACE ${TARGET})
endfunction()

# gnomon_layer_part(LAYER PART FILE...): objects of files of a layer that are compiled with other options than its other files. The
# layer has $<TARGET_OBJECTS:gnomon_LAYER_PART> among its files.
function(gnomon_layer_part LAYER PART)
  set(TARGET gnomon_${LAYER}_${PART})
  add_library(${TARGET} OBJECT ${ARGN})
  gnomon_compile_settings(${TARGET})
  gnomon_reuse_pch(${TARGET} gnomon_pch)
  target_include_directories(${TARGET} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${TARGET} PRIVATE $<TARGET_GENEX_EVAL:gnomon_${LAYER},$<TARGET_PROPERTY:gnomon_${LAYER},LINK_LIBRARIES>>)
endfunction()

# std::stable_sort of libstdc++ 12 calls a function that libstdc++ deprecates itself, and clang 17 and later report it.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_FLAGS "-std=c++20 -Werror=deprecated-declarations")
  check_cxx_source_compiles("#include <algorithm>\nint main() { int a[2] = {1, 0}; std::stable_sort(a, a + 2); }" GNOMON_SORTS_WITHOUT_WARNING)
  unset(CMAKE_REQUIRED_FLAGS)
endif()

# gnomon_compile_settings(TARGET [TEST]). TEST: code of tests. The address and undefined behaviour sanitizers instrument the
# libraries and the program, but not this code, which takes half of its compile time. The thread sanitizer must instrument all.
function(gnomon_compile_settings TARGET)
  target_compile_features(${TARGET} PUBLIC cxx_std_20)
  set_target_properties(${TARGET} PROPERTIES CXX_EXTENSIONS OFF)
  # The module for Python links the static libraries. Not for code of tests and programs, which stays as the compiler makes it by
  # default. A function that another library could replace is not inlined; none replaces ours.
  get_target_property(TYPE ${TARGET} TYPE)
  if(GNOMON_PYTHON AND NOT TYPE STREQUAL "EXECUTABLE" AND NOT "TEST" IN_LIST ARGN)
    set_target_properties(${TARGET} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
  endif()
  target_compile_options(${TARGET} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
    -Wnon-virtual-dtor -Woverloaded-virtual $<$<CXX_COMPILER_ID:Clang>:-Wno-keyword-macro -Wno-overlength-strings>
    $<$<AND:$<CXX_COMPILER_ID:Clang>,$<NOT:$<BOOL:${GNOMON_SORTS_WITHOUT_WARNING}>>>:-Wno-deprecated-declarations>
    $<$<BOOL:${GNOMON_WERROR}>:-Werror>)
  # GCC collects garbage from 512 MiB on instead of 128. Compiling takes a twelfth less time, and a seventh more memory.
  target_compile_options(${TARGET} PRIVATE $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=524288>)
  # Tests call this code for minutes, and GCC compiles it as fast as without. Tests themselves take 1.4 times as long to compile, and code
  # for sanitizers 1.7 times by clang. The linker keeps one copy of each inline function, often ours, so that glslang is faster, too.
  if(NOT "TEST" IN_LIST ARGN AND NOT GNOMON_SANITIZE)
    target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Debug>:-O1>)
  endif()
  # Messages name files of the sources, and builds in two folders are equal (scripts/release).
  target_compile_options(${TARGET} PRIVATE -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=)
  if(GNOMON_SANITIZE)
    if(NOT "TEST" IN_LIST ARGN OR GNOMON_SANITIZE STREQUAL "thread")
      target_compile_options(${TARGET} PRIVATE -fsanitize=${GNOMON_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    endif()
    target_link_options(${TARGET} PUBLIC -fsanitize=${GNOMON_SANITIZE})
    # Tests start the program hundreds of times. A position-independent one has two million relocations with these sanitizers, a quarter
    # of the time of such a start.
    if(TYPE STREQUAL "EXECUTABLE")
      target_link_options(${TARGET} PRIVATE -no-pie)
    endif()
  endif()
endfunction()

# gnomon_optimise_less(TARGET): for code that lists and prints, reads documents, makes devices and programs, decides what a frame does, and
# calls other layers. Full optimisation takes a third of its compile time, and makes no frame measurably faster. GCC 13 and later refuse
# precompiled headers of -O3 for files without the two other options, which -O1 does not set.
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-munroll-only-small-loops GNOMON_HAS_SMALL_LOOPS)
function(gnomon_optimise_less TARGET)
  target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1>)
  if(GNOMON_HAS_SMALL_LOOPS)
    target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-munroll-only-small-loops> $<$<CONFIG:Release>:-mvzeroupper>)
  endif()
endfunction()

# A shared library shows the names of namespace gnomon, and none of the libraries that are linked into it.
function(gnomon_export_symbols TARGET)
  get_target_property(TYPE ${TARGET} TYPE)
  if(TYPE STREQUAL "SHARED_LIBRARY")
    set(SYMBOLS ${PROJECT_SOURCE_DIR}/cmake/exported_symbols.ld)
    target_link_options(${TARGET} PRIVATE -Wl,--version-script=${SYMBOLS} -Wl,--no-undefined)
    set_target_properties(${TARGET} PROPERTIES LINK_DEPENDS ${SYMBOLS} VERSION ${PROJECT_VERSION}
      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH \$ORIGIN)
  endif()
endfunction()
