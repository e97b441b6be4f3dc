# Precompiled headers, if GNOMON_PCH is set.
set(GNOMON_PCH_HEADERS <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory> <optional>
  <set> <span> <sstream> <string> <string_view> <tuple> <variant> <vector>
  <fmt/format.h> <glm/glm.hpp> <glm/gtc/matrix_transform.hpp> <glm/gtc/quaternion.hpp>)

# gnomon_pch_target(NAME KIND LIBRARIES [HEADERS...]): a target whose precompiled headers others reuse. KIND: LIBRARY, or TEST as for
# gnomon_compile_settings.
function(gnomon_pch_target NAME KIND LIBRARIES)
  set(SOURCE ${CMAKE_CURRENT_BINARY_DIR}/${NAME}.cc)
  file(CONFIGURE OUTPUT ${SOURCE} CONTENT "")
  add_library(${NAME} OBJECT ${SOURCE})
  gnomon_compile_settings(${NAME} ${KIND})
  target_link_libraries(${NAME} PRIVATE ${LIBRARIES})
  target_precompile_headers(${NAME} PRIVATE ${GNOMON_PCH_HEADERS} ${ARGN})
endfunction()

# gnomon_reuse_pch(TARGET PCH_TARGET): the compile settings of both must be equal. Also compiles several files of the target as one,
# which parses their other headers and instantiates their templates once. Names in anonymous namespaces must be unique in the target.
function(gnomon_reuse_pch TARGET PCH_TARGET)
  if(GNOMON_PCH)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 24)
    # Other builds warn of these in a file alone.
    target_compile_options(${TARGET} PRIVATE -Wno-shadow $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    # For targets that do not link the library, too.
    target_compile_definitions(${TARGET} PRIVATE $<TARGET_PROPERTY:fmt::fmt,INTERFACE_COMPILE_DEFINITIONS>)
    target_precompile_headers(${TARGET} REUSE_FROM ${PCH_TARGET})
  endif()
endfunction()

if(GNOMON_PCH)
  gnomon_pch_target(gnomon_pch LIBRARY "fmt::fmt;glm::glm")
  if(GNOMON_TESTS)
    gnomon_pch_target(gnomon_test_pch TEST "fmt::fmt;glm::glm;GTest::gtest" <gtest/gtest.h>)
  endif()
endif()
