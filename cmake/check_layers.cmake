# Reports each include of a header that the file's layer must not use, with file and line, and fails. FOLDER: the repository's
# root.
#
# Include folders already separate most layers (cmake/GnomonLayer.cmake). But linking is transitive, and it restricts neither
# external headers nor paths that contain "..".
cmake_minimum_required(VERSION 3.25)

# The layers that each layer may use. A header belongs to the listed folder that contains it.
set(source/trace "")
set(source/memory "")
set(source/output "")
set(source/gpu source/output source/trace shaders)
set(source/shader_check source/gpu shaders)
set(source/draw source/gpu source/memory shaders)
set(source/scene source/memory)
set(source/image "")
set(source/gltf source/scene source/image source/memory source/output source/trace)
set(source/render_scene source/draw source/gpu source/memory source/scene shaders)
set(source/engines/eevee source/render_scene source/draw source/gpu source/scene source/trace shaders)
# Programs that write tables of the engine. The engine itself must not use the reference.
set(source/engines/eevee/table_tools source/reference source/scene shaders)
set(source/engines/unlit source/render_scene source/draw source/gpu source/scene shaders)
set(source/engines/overlay source/render_scene source/draw source/gpu source/scene shaders)
# A program of the build. The engine itself must not use shader_check.
set(source/engines/interface_tool source/engines/eevee source/engines/unlit source/engines/overlay source/shader_check source/gpu shaders)
set(source/embed source/engines/eevee source/engines/unlit source/engines/overlay source/render_scene source/draw source/gpu source/gltf source/image source/scene shaders)
set(source/reference source/scene shaders)
set(source/measure source/engines/eevee source/render_scene source/reference source/draw source/gpu source/gltf
  source/image source/scene shaders)
set(source/verify source/measure source/engines/eevee source/render_scene source/reference source/draw source/gpu source/gltf
  source/image source/scene shaders)
set(source/cli source/view source/verify source/measure source/engines/eevee source/engines/unlit source/engines/overlay source/render_scene source/reference source/draw source/shader_check source/gpu
  source/gltf source/image source/output source/scene source/trace shaders)
set(source/view source/measure source/reference source/engines/eevee source/engines/unlit source/engines/overlay source/render_scene source/draw source/shader_check source/gpu
  source/gltf source/output source/scene shaders)
set(source/description_tool source/view source/engines/eevee source/render_scene source/gltf source/scene)
set(source/python source/measure source/reference source/embed source/engines/eevee source/engines/unlit source/engines/overlay source/render_scene source/draw
  source/shader_check source/gpu source/gltf source/image source/scene shaders)
set(shaders "")
# A folder within another layer's folder comes after it.
set(LAYERS source/trace source/memory source/output source/gpu source/shader_check source/draw source/scene source/image source/gltf source/render_scene source/engines/eevee source/engines/eevee/table_tools
  source/engines/unlit source/engines/overlay source/engines/interface_tool source/embed source/reference source/measure source/verify source/view source/cli source/description_tool source/python shaders)

# The files that use POSIX or Linux alone: the first column of a table of doc/portability.md, which says for what.
set(POSIX_PAGE ${CMAKE_CURRENT_LIST_DIR}/../doc/portability.md)
file(STRINGS ${POSIX_PAGE} ROWS REGEX "^\\| `[a-z_]+\\.(cc|hh)`")
set(POSIX_FILES)
foreach(ROW ${ROWS})
  string(REGEX REPLACE "^\\| ([^|]*) \\|.*" "\\1" CELL "${ROW}")
  string(REGEX MATCHALL "[a-z_]+\\.(cc|hh)" NAMES "${CELL}")
  list(APPEND POSIX_FILES ${NAMES})
endforeach()
set(POSIX_HEADER "^(sys/.*|X11/.*|xcb/.*|linux/.*|dlfcn.h|fcntl.h|poll.h|pthread.h|signal.h|spawn.h|unistd.h)$")

set(VIOLATIONS 0)
# violation(FILE INCLUDE WHY): reports a violation. INCLUDE: the text of the line.
function(violation FILE INCLUDE WHY)
  file(READ ${FOLDER}/${FILE} TEXT)
  string(FIND "\n${TEXT}" "\n${INCLUDE}" OFFSET)
  string(SUBSTRING "\n${TEXT}" 0 ${OFFSET} BEFORE)
  string(REGEX REPLACE "[^\n]" "" NEWLINES "${BEFORE}")
  string(LENGTH "${NEWLINES}" LINE)
  math(EXPR LINE "${LINE} + 1")
  message(NOTICE "${FOLDER}/${FILE}:${LINE}: error: ${INCLUDE}: ${WHY}")
  math(EXPR VIOLATIONS "${VIOLATIONS} + 1")
  set(VIOLATIONS ${VIOLATIONS} PARENT_SCOPE)
endfunction()

# layer_of(PATH RESULT): the layer of a path relative to the root; empty if there is none.
function(layer_of PATH RESULT)
  set(${RESULT} "" PARENT_SCOPE)
  foreach(LAYER ${LAYERS})
    string(FIND "${PATH}" "${LAYER}/" OFFSET)
    if(OFFSET EQUAL 0)
      set(${RESULT} ${LAYER} PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# resolve(FILE NAME RESULT): the path, relative to the root, of the file in this repository that FILE includes as NAME; empty if
# there is none.
function(resolve FILE NAME RESULT)
  cmake_path(GET FILE PARENT_PATH OWN)
  foreach(ROOT ${OWN} ${LAYERS} shaders/shared)
    cmake_path(SET PATH NORMALIZE ${ROOT}/${NAME})
    if(EXISTS ${FOLDER}/${PATH})
      set(${RESULT} ${PATH} PARENT_SCOPE)
      return()
    endif()
  endforeach()
  set(${RESULT} "" PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE FILES RELATIVE ${FOLDER}
  ${FOLDER}/source/*.cc ${FOLDER}/source/*.hh ${FOLDER}/source/*.h ${FOLDER}/shaders/*.hh ${FOLDER}/shaders/*.h
  ${FOLDER}/examples/*.cc ${FOLDER}/examples/*.hh ${FOLDER}/tests/*.cc ${FOLDER}/tests/*.hh)
foreach(FILE ${FILES})
  layer_of(${FILE} OWN_LAYER)
  if(FILE MATCHES "^source/" AND NOT OWN_LAYER)
    message(NOTICE "${FOLDER}/${FILE}:1: error: its folder is no layer that ${CMAKE_CURRENT_LIST_FILE} knows")
    math(EXPR VIOLATIONS "${VIOLATIONS} + 1")
    continue()
  endif()

  # The window, examples and tests act as the host, which owns the context. Vulkan presents to windows of GLFW.
  if(FILE MATCHES "^(source/gpu/gl|source/view|examples|tests)/")
    set(GL_HEADER "^$")
  elseif(FILE MATCHES "^source/gpu/vulkan/")
    set(GL_HEADER "^(GL[0-9]*|GLES[0-9]*|EGL|KHR|epoxy)/")
  else()
    set(GL_HEADER "^(GL[0-9]*|GLES[0-9]*|EGL|KHR|GLFW|epoxy)/")
  endif()

  if(FILE MATCHES "^(source/gpu/vulkan|examples|tests)/")
    set(VULKAN_HEADER "^$")
  else()
    set(VULKAN_HEADER "^vulkan/vulkan.*\\.h$")
  endif()

  file(STRINGS ${FOLDER}/${FILE} INCLUDES REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
  foreach(INCLUDE ${INCLUDES})
    string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*).*" "\\1" NAME "${INCLUDE}")
    if(NAME MATCHES "${GL_HEADER}")
      violation(${FILE} "${INCLUDE}" "only source/gpu/gl/ sees GL headers")
    endif()
    if(NAME MATCHES "${VULKAN_HEADER}")
      violation(${FILE} "${INCLUDE}" "only source/gpu/vulkan/ sees Vulkan headers")
    endif()
    get_filename_component(FILE_NAME ${FILE} NAME)
    if(NAME MATCHES "${POSIX_HEADER}" AND FILE MATCHES "^source/" AND NOT FILE_NAME IN_LIST POSIX_FILES)
      violation(${FILE} "${INCLUDE}" "only the files in the table of doc/portability.md see headers of POSIX")
    endif()
    if(OWN_LAYER)
      resolve(${FILE} ${NAME} PATH)
      layer_of("${PATH}" LAYER)
      if(LAYER AND NOT LAYER STREQUAL OWN_LAYER)
        if(NOT LAYER IN_LIST ${OWN_LAYER})
          violation(${FILE} "${INCLUDE}" "${OWN_LAYER} may not see ${LAYER}")
        elseif(PATH MATCHES "/internal/")
          violation(${FILE} "${INCLUDE}" "internal to ${LAYER}")
        endif()
      elseif(PATH MATCHES "/internal/" AND FILE MATCHES "\\.hh$" AND NOT FILE MATCHES "^source/gpu/(gl|vulkan)/|/internal/")
        violation(${FILE} "${INCLUDE}" "other layers see this header, and not those of internal/")
      elseif(NOT LAYER AND PATH)
        violation(${FILE} "${INCLUDE}" "${OWN_LAYER} may not see ${PATH}")
      endif()
    endif()
  endforeach()
endforeach()
if(VIOLATIONS)
  message(FATAL_ERROR "${VIOLATIONS} includes break the layers; ${CMAKE_CURRENT_LIST_FILE} says which layer may see which")
endif()
